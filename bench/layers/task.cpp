#include "task.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "cloth_sim/scene/load.h"

namespace cloth_sim::bench {
namespace {

constexpr double kSide = 1.0;    // [m]
constexpr double kHeight = 1.0;  // of the middle of a hanging cloth [m]
/// Distance of layers at the start, and of the lower one from the table, over the thickness [-].
constexpr double kLoose = 1.02;
/// Columns over which a layer comes down from the fold.
constexpr int kRamp = 4;

std::string clothText(const std::string& name, double width, int columns, int rows) {
  std::ostringstream out;
  out << "  - {name: " << name << ", size: [" << width << ", " << kSide << "], particles: ["
      << columns << ", " << rows
      << "], fabric: {preset: cotton, areal_density: 0.2}, bending: springs, thickness: "
      << kThickness;
  return out.str();
}

/// Place of a column in the section across the fold [m].
struct Profile {
  double across = 0.0;
  double height = 0.0;
};

/// \param steps  columns from the fold, from 0.
/// \param cell  distance of columns [m].
Profile profileAt(int steps, double cell, bool upper) {
  const double gap = kLoose * kThickness;
  if (!upper) return {cell * steps, gap};
  // The fold is an edge that stands upright; from its end the layer comes down to its place.
  const double fall = std::max(0.0, cell - gap) / kRamp;
  const double along = std::sqrt(cell * cell - fall * fall);
  const int down = std::min(steps, kRamp);
  return {along * down + cell * (steps - down), gap + cell - fall * down};
}

/// The first column of the upper layer.
int foldOf(const LayersTask& task) {
  const int n = task.particles;
  return task.start == Start::kHemmed ? n - n / 8 : n / 2;
}

Vec3 foldedAt(int column, int row, const LayersTask& task) {
  const int n = task.particles;
  const double cell = kSide / (n - 1);
  const int fold = foldOf(task);
  const bool upper = column >= fold;
  const Profile p = profileAt(upper ? column - fold : fold - 1 - column, cell, upper);
  return Vec3(-p.across, (row - 0.5 * (n - 1)) * cell, p.height);
}

Vec3 hangingAt(int column, int row, int n) {
  const double cell = kSide / (n - 1);
  return Vec3((column - 0.5 * (n - 1)) * cell, 0.0, kHeight + (row - 0.5 * (n - 1)) * cell);
}

VertexId vertexOf(const LayersTask& task, int column, int row) {
  const int n = task.particles;
  if (task.start != Start::kTwoHalves) return row * n + column;
  const int half = n / 2;
  return column < half ? row * half + column : half * n + row * half + column - half;
}

}  // namespace

Scene sceneOf(const LayersTask& task, bool layers) {
  const int n = task.particles;
  std::ostringstream out;
  out << "cloth:\n";
  if (task.start == Start::kTwoHalves) {
    const int cells = n / 2 - 1;  // across a half
    const double half = kSide * cells / (n - 1);
    out << clothText("lower", half, n / 2, n) << "}\n"
        << clothText("upper", half, n / 2, n) << ", pose: {position: [0, 0, 1]}}\n";
  } else if (task.start == Start::kHanging) {
    out << clothText("cloth", kSide, n, n) << ", pose: {position: [0, 0, " << kHeight
        << "], rpy: [1.5707963267948966, 0, 0]}, pins: [corner_01, corner_11]}\n";
  } else {
    out << clothText("cloth", kSide, n, n) << "}\n";
  }
  if (task.start != Start::kHanging) {
    out << "obstacles:\n  table: {type: plane, friction: 0.5}\n";
  }
  out << "drag: 0.5\nself_contact: " << (layers ? "true" : "false")
      << "\nsolver: {sleep: false}\nphases: [{name: all, timeout: 1000.0}]\n";
  return parseScene(out.str(), "layers", {});
}

std::vector<Vec3> startOf(const LayersTask& task) {
  const int n = task.particles;
  std::vector<Vec3> x(static_cast<std::size_t>(n) * n);
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      x[vertexOf(task, column, row)] =
          task.start == Start::kHanging ? hangingAt(column, row, n) : foldedAt(column, row, task);
    }
  }
  return x;
}

std::vector<double> gapsOf(const LayersTask& task, const std::vector<Vec3>& x) {
  std::vector<double> gaps;
  if (task.start == Start::kHanging) return gaps;
  const int n = task.particles;
  const int fold = foldOf(task);
  for (int row = 0; row < n; ++row) {
    for (int steps = std::max(kRamp, n / 20); fold + steps < n; ++steps) {
      gaps.push_back(x[vertexOf(task, fold + steps, row)].z() -
                     x[vertexOf(task, fold - 1 - steps, row)].z());
    }
  }
  return gaps;
}

}  // namespace cloth_sim::bench
