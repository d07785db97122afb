#include "compact_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace cloth_sim {
namespace {

constexpr double kUnit = 1e-4;                                          ///< [m]
constexpr double kMost = std::numeric_limits<std::int16_t>::max() - 1;  ///< of an increment

using Units = std::array<std::int64_t, 3>;

/// Returns the least unit, from kUnit on, in which the increments of the positions fit [m].
double unitFor(const std::vector<Vec3>& positions) {
  double largest = 0.0;
  for (std::size_t v = 1; v < positions.size(); ++v) {
    largest = std::max(largest, (positions[v] - positions[v - 1]).cwiseAbs().maxCoeff());
  }
  return std::max(kUnit, largest / kMost);
}

Units roundTo(double unit, const Vec3& offset) {
  Units units{};
  for (int axis = 0; axis < 3; ++axis) units[axis] = std::llround(offset[axis] / unit);
  return units;
}

}  // namespace

void fillCompactFrame(const Snapshot& snapshot, const std_msgs::Header& header,
                      CompactFrame& message) {
  const std::vector<Vec3>& positions = snapshot.positions;
  message.header = header;
  message.revision = snapshot.topology->revision;
  message.step = snapshot.step;
  message.time = snapshot.time;
  message.unit = unitFor(positions);
  message.increments.resize(3 * positions.size());
  if (positions.empty()) return;
  const Vec3& origin = positions.front();
  for (int axis = 0; axis < 3; ++axis) message.origin[axis] = origin[axis];
  Units before{};
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Units units = roundTo(message.unit, positions[v] - origin);
    for (int axis = 0; axis < 3; ++axis) {
      message.increments[3 * v + axis] = static_cast<std::int16_t>(units[axis] - before[axis]);
    }
    before = units;
  }
}

std::string expandFrame(const CompactFrame& compact, ClothFrame& frame) {
  if (compact.increments.size() % 3 != 0) return "its increments are not three for each vertex";
  if (!(compact.unit > 0.0) || !std::isfinite(compact.unit)) return "its unit is no length";
  frame.header = compact.header;
  frame.revision = compact.revision;
  frame.step = compact.step;
  frame.time = compact.time;
  frame.positions.resize(compact.increments.size());
  Units units{};
  for (std::size_t k = 0; k < compact.increments.size(); ++k) {
    const std::size_t axis = k % 3;
    units[axis] += compact.increments[k];
    frame.positions[k] =
        static_cast<float>(compact.origin[axis] + compact.unit * static_cast<double>(units[axis]));
  }
  return "";
}

}  // namespace cloth_sim
