/// \file The energy that a tear releases, and the tears that it decides.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "surgery/energy_release.h"
#include "surgery/tear_line.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using testing_support::complaint;

/// Returns a trouser tear of a strip of 0.05 x 0.2 m that is its whole cloth, pulled slowly.
/// \param energy  tear energy of the fabric, as YAML [J/m].
std::string trouserScene(const std::string& energy, const std::string& solver,
                         const std::string& tearing = "{enabled: false}") {
  return R"(
cloth:
  size: [0.2, 0.05]
  particles: [33, 9]
  fabric: {tensile_warp: 4500, tensile_weft: 4500, shear: 1500, tear_energy: )" +
         energy + R"(}
  bending: plate
solver: {)" +
         solver + R"(}
gravity: [0, 0, 0]
drag: 20
clamps:
  up:
    pose: {position: [-0.094, -0.0125, 0]}
    plate_size: [0.013, 0.023]
    gap_open: 0.02
    gap_closed: 0.002
  down:
    pose: {position: [-0.094, 0.0125, 0]}
    plate_size: [0.013, 0.023]
    gap_open: 0.02
    gap_closed: 0.002
tearing: )" +
         tearing + R"(
phases:
  - name: grasp
    notch: [[0.0, 0.025], [0.08, 0.025]]
    clamps: {all: {grasp: true}}
    until: {clamps: closed}
    timeout: 1
  - name: bend
    clamps:
      up: {move_by: [0.074, 0, 0.06], speed: 0.3}
      down: {move_by: [0.074, 0, -0.06], speed: 0.3}
    until: {clamps: at_target}
    timeout: 2
  - name: pull
    tearing: {enabled: true}
    clamps:
      up: {move_by: [0, 0, 0.1], speed: 0.02}
      down: {move_by: [0, 0, -0.1], speed: 0.02}
    timeout: 3
)";
}

constexpr char kVerlet[] = "method: verlet, substeps: 800";
constexpr char kProjective[] = "method: projective, substeps: 4, iterations: 10";

VertexId tipOf(const TriangleMesh& mesh) {
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
    if (isTip(mesh, v)) return v;
  }
  return kNone;
}

double meanForce(const Simulation& simulation) {
  double sum = 0.0;
  for (const Clamp& clamp : simulation.clamps()) sum += clamp.wrench().force.norm();
  return sum / static_cast<double>(simulation.clamps().size());
}

void runUntil(Simulation& simulation, double time) {
  while (simulation.time() < time && !simulation.failed()) simulation.step();
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
}

TEST(MaterialForce, IsTwiceTheForceOfATrouserTear) {
  Simulation simulation(parseScene(trouserScene("1000", kVerlet), "trouser.yaml"));
  for (const double time : {1.1, 1.3, 1.5}) {
    runUntil(simulation, time);
    const double force = meanForce(simulation);
    EXPECT_GT(force, 0.5);
    const Vec2 released =
        materialForce(simulation.model(), simulation.state(), tipOf(simulation.model().mesh));
    // Legs of 112 N per strain: the release counts their stretch, F / 112 at most.
    EXPECT_NEAR(released.x(), 2.0 * force, (0.03 + force / 112.0) * 2.0 * force) << time;
    EXPECT_NEAR(released.y(), 0.0, 0.02 * released.x()) << "straight ahead";
  }
}

TEST(MaterialForce, IsTheEnergyOfThePartThatATearUnloads) {
  // A long strip between two clamped edges, pulled across and cut along its middle half way: as the
  // tear advances, stretched cloth ahead becomes slack cloth behind, so it releases the energy
  // C22 e^2 / 2 of the height H (Rivlin & Thomas 1953, "pure shear"), C22 = q of docs/model.md.
  Simulation simulation(parseScene(R"(
cloth:
  size: [0.4, 0.1]
  particles: [81, 21]
  fabric: {tensile_warp: 1000, tensile_weft: 1000, shear: 300}
  bending: none
solver: {method: projective, iterations: 40}
gravity: [0, 0, 0]
drag: 40
clamps:
  lower: {pose: {position: [0, -0.05, 0]}, plate_size: [0.42, 0.006], gap_open: 0.02, gap_closed: 0.002}
  upper: {pose: {position: [0, 0.05, 0]}, plate_size: [0.42, 0.006], gap_open: 0.02, gap_closed: 0.002}
phases:
  - name: grasp
    notch: [[0, 0.05], [0.2, 0.05]]
    clamps: {all: {grasp: true}}
    until: {clamps: closed}
    timeout: 1
  - name: pull
    clamps: {lower: {move_by: [0, -0.001, 0], speed: 0.01}, upper: {move_by: [0, 0.001, 0], speed: 0.01}}
    timeout: 3
)",
                                   "strip.yaml"));
  runUntil(simulation, 2.0);
  const double q = 0.5 * (1000.0 + std::sqrt(1000.0 * 1000.0 + 4.0 * 300.0 * 300.0));
  const double expected = 0.5 * q * 0.02 * 0.02 * 0.1;
  const Vec2 released =
      materialForce(simulation.model(), simulation.state(), tipOf(simulation.model().mesh));
  EXPECT_NEAR(released.x(), expected, 0.05 * expected);
  // Diagonals of one way make the halves differ.
  EXPECT_NEAR(released.y(), 0.0, 0.2 * expected);
}

TEST(MaterialForce, VanishesAtRest) {
  Simulation simulation(parseScene(trouserScene("1000", kProjective), "trouser.yaml"));
  simulation.step();
  EXPECT_NEAR(
      materialForce(simulation.model(), simulation.state(), tipOf(simulation.model().mesh)).norm(),
      0.0, 1e-9);
}

TEST(MostDrivenAdvance, FollowsTheForceInAnIsotropicFabric) {
  const Vec2 force = 6.0 * Vec2(std::cos(0.3), std::sin(0.3));
  const TearAdvance advance = mostDrivenAdvance(force, TearEnergy::of(12.0, 12.0));
  EXPECT_NEAR((advance.direction - force.normalized()).norm(), 0.0, 1e-15);
  EXPECT_NEAR(advance.load, 0.5, 1e-15);
}

TEST(MostDrivenAdvance, FollowsAThreadOfAWeave) {
  for (const double angle : {-0.3, -0.1, 0.0, 0.2}) {
    const Vec2 force = 6.0 * Vec2(std::cos(angle), std::sin(angle));
    const TearAdvance advance = mostDrivenAdvance(force, {12.0, 12.0, 17.0});
    EXPECT_EQ(advance.direction, Vec2(1.0, 0.0)) << angle;
    EXPECT_NEAR(advance.load, 0.5 * std::cos(angle), 1e-15);
  }
}

TEST(MostDrivenAdvance, TurnsToTheWeakerThreads) {
  const TearAdvance advance =
      mostDrivenAdvance({std::sqrt(0.5), std::sqrt(0.5)}, TearEnergy::of(2.0, 20.0));
  EXPECT_GT(advance.direction.y(), 0.9) << "along v it breaks the weak warp";
}

TEST(TearByEnergy, WaitsForItsForceAndRunsStraightOn) {
  Simulation simulation(
      parseScene(trouserScene("{warp: 2, weft: 2, bias: 2.8}", kProjective), "trouser.yaml"));
  const std::int32_t before = [&] {
    simulation.step();
    return simulation.model().particleCount();
  }();
  double highest = 0.0;
  while (simulation.model().particleCount() == before) {
    simulation.step();
    highest = std::max(highest, meanForce(simulation));
    ASSERT_LT(simulation.time(), 3.0);
  }
  EXPECT_NEAR(highest, 1.0, 0.15) << "2 J/m tear at 1 N; the first time at a blunt end";
  runUntil(simulation, 3.2);
  const Vec2 tip = simulation.model().mesh.material(tipOf(simulation.model().mesh));
  EXPECT_GT(tip.x(), 0.1);
  EXPECT_NEAR(tip.y(), 0.025, 2.0 * 0.2 / 32.0) << "strays by less than two cells";
}

TEST(TearByEnergy, DoesNotBeginWithoutATip) {
  std::string scene = trouserScene("0.001", kProjective);
  scene.replace(scene.find("    notch: [[0.0, 0.025], [0.08, 0.025]]\n"), 41, "");
  Simulation simulation(parseScene(scene, "whole.yaml"));
  const std::int32_t before = simulation.model().particleCount();
  runUntil(simulation, 2.0);
  EXPECT_EQ(simulation.model().particleCount(), before);
}

TEST(TearByEnergy, GoesOnFromASavedState) {
  const Scene scene = parseScene(trouserScene("2", kProjective), "trouser.yaml");
  Simulation whole(scene);
  runUntil(whole, 1.6);
  const std::string saved = whole.save();
  runUntil(whole, 2.4);
  Simulation again(scene);
  ASSERT_TRUE(again.apply(Restore{saved}).success);
  runUntil(again, 2.4);
  EXPECT_EQ(again.save(), whole.save());
}

TEST(TearByEnergy, BadInputIsRefusedInOneLine) {
  using testing::HasSubstr;
  for (const char* value : {"0", "-3", ".nan", "{warp: 2}", "{warp: 2, weft: 0}", "much"}) {
    const std::string error = complaint(trouserScene(value, kProjective));
    EXPECT_THAT(error, HasSubstr("cloth.fabric.tear_energy")) << value;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
  EXPECT_THAT(complaint(trouserScene("2", kProjective, "{enabled: false, ratio: 1.2}")),
              HasSubstr("cloth.fabric.tear_energy: expected either an energy or a tearing.ratio"));
  for (const char* method : {"xpbd", "line_xpbd"}) {
    EXPECT_THAT(complaint(trouserScene("2", std::string("method: ") + method)),
                HasSubstr("cannot tear by energy"))
        << method;
  }
}

TEST(TearByEnergy, RefusesRatiosWhileItRuns) {
  Simulation simulation(parseScene(trouserScene("2", kProjective), "trouser.yaml"));
  TearRatios ratio;
  ratio.fill(1.5);
  const CommandResult result = simulation.apply(SetTearing{true, ratio});
  EXPECT_FALSE(result.success);
  EXPECT_EQ(result.message, "tear ratio: this scene tears by the energy of its fabric");
  EXPECT_TRUE(simulation.apply(SetTearing{true, infiniteRatios()}).success);
}

TEST(TearByEnergy, TakesTheEnergyOfThePresetOnRequest) {
  const std::string scene = R"(
cloth: {fabric: denim}
solver: {method: projective}
)";
  const Scene read = parseScene(scene + "tearing: {by: energy}\n", "s.yaml");
  ASSERT_EQ(read.tearing.energy.size(), 1U);
  EXPECT_EQ(read.tearing.energy[0].warp, fabricPreset("denim").tearEnergy.warp);
  EXPECT_TRUE(parseScene(scene + "tearing: {}\n", "s.yaml").tearing.energy.empty());
  EXPECT_THAT(complaint(scene + "tearing: {by: energy, ratio: 1.2}\n"),
              testing::HasSubstr("tearing.by: expected either an energy or a tearing.ratio"));
  EXPECT_THAT(complaint(scene + "tearing: {by: luck}\n"), testing::HasSubstr("tearing.by"));
  EXPECT_THAT(complaint(trouserScene("2", kProjective, "{by: stretch}")),
              testing::HasSubstr("tear_energy: expected only where cloth tears by energy"));
}

}  // namespace
}  // namespace cloth_sim
