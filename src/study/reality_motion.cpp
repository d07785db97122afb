#include "reality_motion.h"

#include <cmath>
#include <vector>

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/scene/build.h"
#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "reality_cloth.h"

namespace cloth_sim {
namespace {

// ---- slope --------------------------------------------------------------------------------------

/// A cloth on a larger one on a board, with gravity turned as on a slope.
std::string slopeScene(double friction, double degrees) {
  const double angle = degrees * M_PI / 180.0;
  std::string yaml = "cloth:\n";
  for (const bool isUpper : {false, true}) {
    const std::string size = isUpper ? "0.2" : "0.24";
    yaml += std::string("  - {name: ") + (isUpper ? "upper" : "lower") + ", size: [" + size + ", " +
            size + "], particles: [17, 17], fabric: cotton, thickness: 0.001, bending: plate, " +
            "pose: {position: [0, 0, " + (isUpper ? "0.0018" : "0.0005") + "]}}\n";
  }
  return yaml + "self_contact: true\nlayer_friction: " + std::to_string(friction) + "\ngravity: [" +
         std::to_string(kRealityGravity * std::sin(angle)) + ", 0, " +
         std::to_string(-kRealityGravity * std::cos(angle)) + "]\n" +
         "solver: {method: line_xpbd, error: 0.01, sleep: false}\n"
         "obstacles: {table: {type: board, size: [1, 1, 0.1], position: [0, 0, -0.05], "
         "friction: 5}}\n";
}

// ---- swing --------------------------------------------------------------------------------------

constexpr double kFirstZero = 2.404825557695773;  ///< of the Bessel function J0

/// Angular frequency of the first mode of a heavy string [rad/s].
double swingFrequency() { return 0.5 * kFirstZero * std::sqrt(kRealityGravity / kSwingLength); }

/// The first mode, 1 at the lower end. \param height  over the lower end [m].
double swingMode(double height) {
  return std::cyl_bessel_j(0.0, kFirstZero * std::sqrt(std::max(0.0, height) / kSwingLength));
}

/// Mean of a power of the mode over the length.
double meanPower(int power) {
  constexpr int kParts = 2000;
  double sum = 0.0;
  for (int k = 0; k < kParts; ++k) {
    sum += std::pow(swingMode(kSwingLength * (k + 0.5) / kParts), power);
  }
  return sum / kParts;
}

/// The strip, one cell wide, in the shape of the mode.
HeldCloth swingingStrip(const std::string& preset) {
  constexpr int kCells = 20;
  Fabric fabric = fabricPreset(preset);
  fabric.damping = 0.0;
  fabric.tensileWarp = fabric.tensileWeft = 500.0;
  fabric.shear = 50.0;
  const double spacing = kSwingLength / kCells;
  const ClothSpec spec = stripOf(fabric, kCells, 2, spacing);
  HeldMethod method{"verlet", {{"substeps", 1.0}}, 0.0};
  method.dt = 0.25 * stableStep(buildModel(spec));
  HeldCloth cloth(spec, method);
  const Grid grid = *cloth.model().cloths[0].grid;
  double x = 0.0, z = 0.0;
  for (int column = 0; column <= kCells; ++column) {
    const double next = 0.1 * kSwingLength * swingMode(column * spacing);
    if (column == 0) x = next;
    if (column > 0) z += std::sqrt(spacing * spacing - (next - x) * (next - x));
    x = next;
    for (const int row : {0, 1}) {
      cloth.state.x[grid.vertex(column, row)] = Vec3(x, row * spacing, z);
      if (column == kCells) cloth.hold(grid.vertex(column, row));
    }
  }
  return cloth;
}

/// Fits a line to the inverse amplitudes.
SwingDecay decayOf(const std::vector<double>& times, const std::vector<double>& amplitudes) {
  SwingDecay decay;
  const auto n = static_cast<double>(times.size());
  double t = 0.0, tt = 0.0, y = 0.0, ty = 0.0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    t += times[k];
    tt += times[k] * times[k];
    y += 1.0 / amplitudes[k];
    ty += times[k] / amplitudes[k];
  }
  decay.rate = (n * ty - t * y) / (n * tt - t * t);
  decay.period = 2.0 * (times.back() - times.front()) / (n - 1.0);
  decay.first = amplitudes[1];
  decay.last = amplitudes.back();
  return decay;
}

}  // namespace

double slideOnSlope(double friction, double degrees) {
  Simulation simulation(parseScene(slopeScene(friction, degrees), "slope"));
  const auto middle = [&](std::size_t cloth) {
    const ClothPart& part = simulation.model().cloths[cloth];
    return simulation.state().x[part.firstVertex + part.vertices / 2].x();
  };
  for (int step = 0; step < 3; ++step) simulation.step();
  const double before = middle(1) - middle(0);
  for (int step = 0; step < 15; ++step) simulation.step();
  return middle(1) - middle(0) - before;
}

SwingDecay simulateSwing(const std::string& preset, bool air) {
  HeldCloth cloth = swingingStrip(preset);
  if (air) cloth.controls.wind = Wind();
  const VertexId tip = cloth.model().cloths[0].grid->vertex(0, 0);
  // A half swing lasts from one passage of the tip through the middle to the next.
  std::vector<double> times, amplitudes;
  double largest = 0.0, largestAt = 0.0, before = cloth.state.x[tip].x();
  while (cloth.time() < kSwingTime) {
    cloth.step();
    const double x = cloth.state.x[tip].x();
    if (x * before < 0.0) {
      if (largestAt > 0.0) {  // not before the first passage
        times.push_back(largestAt);
        amplitudes.push_back(largest);
      }
      largest = 0.0;
      largestAt = cloth.time();
    }
    if (largestAt > 0.0 && std::abs(x) > largest) {
      largest = std::abs(x);
      largestAt = cloth.time();
    }
    before = x;
  }
  return decayOf(times, amplitudes);
}

SwingDecay swingByTheory(const std::string& preset) {
  const Wind air;
  SwingDecay decay;
  decay.period = 2.0 * M_PI / swingFrequency();
  decay.rate = 2.0 * air.density * air.dragCoefficient * swingFrequency() * meanPower(3) /
               (3.0 * M_PI * fabricPreset(preset).arealDensity * meanPower(2));
  const double start = 1.0 / (0.1 * kSwingLength);
  decay.first = 1.0 / (start + decay.rate * decay.period);
  decay.last = 1.0 / (start + decay.rate * kSwingTime);
  return decay;
}

double periodWithMovedAir(const std::string& preset, double width) {
  const double cloth = fabricPreset(preset).arealDensity;
  const double moved = 0.25 * M_PI * Wind().density * width;
  return 2.0 * M_PI / swingFrequency() * std::sqrt((cloth + moved) / cloth);
}

}  // namespace cloth_sim
