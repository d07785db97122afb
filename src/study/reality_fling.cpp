#include "reality_fling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/scene/build.h"
#include "reality_cloth.h"
#include "reference.h"

namespace cloth_sim {
namespace {

constexpr double kFlingStep = 1.0 / 60.0;  ///< [s]
constexpr int kStepsPerFrame = 12;         ///< between two records
constexpr double kSettling = 1.0;          ///< hanging at rest before the motion [s]

struct FlingSegment {
  double duration = 0.0;                    ///< [s]
  double y = 0.0, z = 0.0;                  ///< displacements [m]
  double startSpeed = 0.0, endSpeed = 0.0;  ///< along y [m/s]
};

constexpr std::array<FlingSegment, 4> kFlingSegments{{{1.1, -0.25, 0.06, 0.0, -0.7},
                                                      {1.5, 0.30, 0.06, -0.7, 0.0},
                                                      {1.3, 0.15, -0.51, 0.0, -0.3},
                                                      {0.5, -0.10, -0.51, -0.3, 0.0}}};

/// The quintic from 0 to `by` in a unit of time with given slopes and no curvature at its ends.
double quintic(double u, double by, double startSlope, double endSlope) {
  const double a = by - startSlope, b = endSlope - startSlope;
  return startSlope * u + (10.0 * a - 4.0 * b) * std::pow(u, 3) +
         (-15.0 * a + 7.0 * b) * std::pow(u, 4) + (6.0 * a - 3.0 * b) * std::pow(u, 5);
}

HeldMethod methodOf(const FlingSetting& setting, const ClothSpec& spec) {
  const SolverInfo& info = findSolver(setting.method);
  HeldMethod method{setting.method, {}, kFlingStep};
  int substeps = setting.substeps;
  if (substeps == 0 && setting.error == 0.0) {
    substeps = static_cast<int>(std::ceil(kFlingStep / (0.5 * stableStep(buildModel(spec)))));
  }
  if (substeps > 0 && findParameter(info, "substeps") != nullptr) {
    method.parameters["substeps"] = substeps;
  }
  if (setting.error > 0.0) method.parameters["error"] = setting.error;
  return method;
}

/// Index of a particle that is there at every resolution.
std::size_t commonParticle(const Fling& fling, int column, int row) {
  const int every = (fling.setting.columns - 1) / 10;
  return static_cast<std::size_t>(row * every * fling.setting.columns + column * every);
}

}  // namespace

Vec3 flingDisplacement(double time) {
  Vec3 result = Vec3::Zero();
  for (const FlingSegment& s : kFlingSegments) {
    const double u = std::clamp(time / s.duration, 0.0, 1.0);
    result.y() += quintic(u, s.y, s.startSpeed * s.duration, s.endSpeed * s.duration);
    result.z() += quintic(u, s.z, 0.0, 0.0);
    time -= s.duration;
    if (time <= 0.0) break;
  }
  return result;
}

double flingDuration() {
  double sum = 0.0;
  for (const FlingSegment& s : kFlingSegments) sum += s.duration;
  return sum;
}

Fling simulateFling(const FlingSetting& setting) {
  Fling fling;
  fling.setting = setting;
  fling.rows = 7 * (setting.columns - 1) / 5 + 1;
  ClothSpec spec;
  spec.columns = setting.columns;
  spec.rows = fling.rows;
  spec.width = 0.5;
  spec.height = 0.7;
  spec.fabric = fabricPreset("cotton");
  spec.springs = {true, false};
  spec.plate = true;
  spec.pose.orientation = Quat(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX()));
  spec.pose.position.z() = -0.35;  // the corners begin at z = 0
  HeldCloth cloth(spec, methodOf(setting, spec));
  cloth.controls.wind = Wind();
  const Grid grid = *cloth.model().cloths[0].grid;
  cloth.hold(grid.vertex(0, grid.rows - 1));
  cloth.hold(grid.vertex(grid.columns - 1, grid.rows - 1));
  const int settling = static_cast<int>(std::lround(kSettling / kFlingStep));
  const int steps = static_cast<int>(std::lround(flingDuration() / kFlingStep));
  for (int k = 1 - settling; k <= steps; ++k) {
    const double time = k * kFlingStep;
    cloth.moveHeld(flingDisplacement(std::max(0.0, time)) -
                   flingDisplacement(std::max(0.0, time - kFlingStep)));
    cloth.step();
    if (k < 0 || k % kStepsPerFrame != 0) continue;
    fling.times.push_back(time);
    fling.positions.push_back(cloth.state.x.values());
  }
  return fling;
}

double flingDistance(const Fling& a, const Fling& b) {
  double square = 0.0;
  int count = 0;
  for (std::size_t frame = 0; frame < a.times.size(); ++frame) {
    for (int row = 0; row <= 14; ++row) {
      for (int column = 0; column <= 10; ++column, ++count) {
        square += (a.positions[frame][commonParticle(a, column, row)] -
                   b.positions[frame][commonParticle(b, column, row)])
                      .squaredNorm();
      }
    }
  }
  return std::sqrt(square / count);
}

double flingChamfer(const Fling& from, const Fling& to) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t frame = 0; frame < from.times.size(); ++frame) {
    for (const Vec3& x : from.positions[frame]) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vec3& y : to.positions[frame]) nearest = std::min(nearest, (x - y).squaredNorm());
      sum += std::sqrt(nearest);
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

}  // namespace cloth_sim
