/// \file Slits with a refined mesh around them, in a cotton that hangs in a wind, with the default
/// method. Threads of an eighth of a cell need more substeps than those of the cells:
/// docs/limits.md has the strains.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <sstream>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {
namespace {

/// Notches of 4 cm in random places and directions, three bisections fine.
std::string slits(int count) {
  std::mt19937 random(3);
  const auto between = [&](double low, double high) {
    return low + (high - low) * random() / 4294967296.0;
  };
  std::ostringstream text;
  for (int k = 0; k < count; ++k) {
    const double u = between(0.1, 0.9);
    const double v = between(0.1, 0.8);
    const double angle = between(0.0, M_PI);
    const double du = 0.02 * std::cos(angle);
    const double dv = 0.02 * std::sin(angle);
    text << (k > 0 ? ", " : "") << "{path: [[" << u - du << ", " << v - dv << "], [" << u + du
         << ", " << v + dv << "]]}";
  }
  return text.str();
}

/// \param particles  along a side of 1 m.
std::string curtain(int particles, int count) {
  std::ostringstream text;
  text << "cloth: {particles: [" << particles << ", " << particles << R"(], size: [1, 1],
  pose: {position: [0.5, 0, 0.5], rpy: [1.5708, 0, 0]}, fabric: cotton, bending: springs, pins: [last_row],
  surgery: {refine_cuts: {radius: 0.012, generations: 3}, max_particles: 100000}}
wind: {velocity: [0, 5, 0]}
tearing: {enabled: true, ratio: 1.3}
phases: [{name: hang, timeout: 0.3}, {name: cut, timeout: 0.4, notch: [)"
       << slits(count) << "]}]\n";
  return text.str();
}

/// Runs to the end of the phases. \return the largest strain.
double run(Simulation& simulation) {
  while (!simulation.failed() && simulation.script().status() != ScriptStatus::kDone) {
    simulation.step();
    simulation.observeMaxStretch();
  }
  EXPECT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_GT(simulation.broken().cut, 0);
  return simulation.maxStretchSeen() - 1.0;
}

TEST(RefinedSlits, OfACoarseClothDoNotTearOn) {
  Simulation simulation(parseScene(curtain(33, 12), "slits.yaml"));
  const double strain = run(simulation);
  RecordProperty("strain", std::to_string(strain));
  EXPECT_LT(strain, 0.3);
  EXPECT_EQ(simulation.broken().torn, 0);
}

/// The default of 30 substeps is too few where threads are 2 mm long, and the run says so.
TEST(RefinedSlits, OfAFineClothAreWarnedOfOrNeedMoreSubsteps) {
  const std::string scene = curtain(65, 25);
  Simulation usual(parseScene(scene, "slits.yaml", {"tearing.enabled=false"}));
  const double strain = run(usual);
  RecordProperty("strain", std::to_string(strain));
  EXPECT_FALSE(usual.warnings().empty());
  Simulation fine(parseScene(scene, "slits.yaml", {"solver.substeps=120"}));
  const double fineStrain = run(fine);
  RecordProperty("fine_strain", std::to_string(fineStrain));
  EXPECT_LT(fineStrain, 0.3);
  EXPECT_LT(fineStrain, strain);
  EXPECT_EQ(fine.broken().torn, 0);
}

}  // namespace
}  // namespace cloth_sim
