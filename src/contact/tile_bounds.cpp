#include "tile_bounds.h"

#include <algorithm>

#include "closest_lanes.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

static_assert(GridTile::kColumns == kLanes);

[[gnu::always_inline]] inline Lanes lower(const Lanes& a, const Lanes& b) { return a < b ? a : b; }
[[gnu::always_inline]] inline Lanes upper(const Lanes& a, const Lanes& b) { return a > b ? a : b; }

/// A box that grows, in four lanes.
struct BoxLanes {
  Lanes3 low = {Lanes{} + 1e300, Lanes{} + 1e300, Lanes{} + 1e300};
  Lanes3 high = {Lanes{} - 1e300, Lanes{} - 1e300, Lanes{} - 1e300};
};

[[gnu::always_inline]] inline void add(const Lanes3& at, BoxLanes& box) {
  box.low = {lower(at.x, box.low.x), lower(at.y, box.low.y), lower(at.z, box.low.z)};
  box.high = {upper(at.x, box.high.x), upper(at.y, box.high.y), upper(at.z, box.high.z)};
}

[[gnu::always_inline]] inline double leastLane(const Lanes& of) {
  return std::min(std::min(of[0], of[1]), std::min(of[2], of[3]));
}
[[gnu::always_inline]] inline double mostLane(const Lanes& of) {
  return std::max(std::max(of[0], of[1]), std::max(of[2], of[3]));
}

[[gnu::always_inline]] inline Box boxOf(const BoxLanes& box) {
  return {{leastLane(box.low.x), leastLane(box.low.y), leastLane(box.low.z)},
          {mostLane(box.high.x), mostLane(box.high.y), mostLane(box.high.z)}};
}

[[gnu::always_inline]] inline double meanOf(const Lanes& of, std::int32_t groups) {
  return (of[0] + of[1] + of[2] + of[3]) / (kLanes * groups);
}

[[gnu::always_inline]] inline Vec3 meanOf(const Lanes3& of, std::int32_t groups) {
  return {meanOf(of.x, groups), meanOf(of.y, groups), meanOf(of.z, groups)};
}

[[gnu::always_inline]] inline Lanes3 lanesOf(const Vec3& of) {
  const Lanes zero{};
  return {zero + of.x(), zero + of.y(), zero + of.z()};
}

/// A row of vertices: all but the last, and all but the first.
struct RowLanes {
  Lanes3 left;
  Lanes3 right;
};

[[gnu::always_inline]] inline Lanes3 lanesFrom(const ConstAxes& x, std::int32_t first) {
  return {lanesAt(x.x + first), lanesAt(x.y + first), lanesAt(x.z + first)};
}

[[gnu::always_inline]] inline Lanes squareOf(const Lanes3& edge, double inverse,
                                             const Lanes3& centre) {
  const Lanes3 off = (Lanes{} + inverse) * edge - centre;
  return dot(off, off);
}

/// A face has one side along u and one along v, which are its gradient. So the farthest side of
/// each kind of a cell bounds the gradients of its faces.
CLOTH_SIM_VECTOR_CLONES
void boundCells(const GridTile& tile, const ConstAxes& x, TileBounds& bounds) {
  RowLanes rows[GridTile::kMostRows];
  BoxLanes box;
  Lanes3 alongU{};  // sums of sides
  for (std::int32_t j = 0; j < tile.rows; ++j) {
    const std::int32_t first = tile.first + j * tile.stride;
    rows[j] = {lanesFrom(x, first), lanesFrom(x, first + 1)};
    add(rows[j].left, box);
    add(rows[j].right, box);
    alongU = alongU + (rows[j].right - rows[j].left);
  }
  bounds.box = boxOf(box);
  const std::int32_t last = tile.rows - 1;
  const Lanes3 alongV = (rows[last].left - rows[0].left) + (rows[last].right - rows[0].right);
  const double inverseU = 1.0 / tile.cell.x();
  const double inverseV = 1.0 / tile.cell.y();
  Gradient& centre = bounds.ball.centre;
  centre = {inverseU * meanOf(alongU, tile.rows), inverseV * meanOf(alongV, 2 * last)};
  const Lanes3 u = lanesOf(centre.u);
  const Lanes3 v = lanesOf(centre.v);
  Lanes most{};
  Lanes below = squareOf(rows[0].right - rows[0].left, inverseU, u);
  for (std::int32_t j = 1; j < tile.rows; ++j) {
    const Lanes above = squareOf(rows[j].right - rows[j].left, inverseU, u);
    const Lanes left = squareOf(rows[j].left - rows[j - 1].left, inverseV, v);
    const Lanes right = squareOf(rows[j].right - rows[j - 1].right, inverseV, v);
    most = upper(upper(below, above) + upper(left, right), most);
    below = above;
  }
  bounds.ball.radius = std::sqrt(mostLane(most));
}

}  // namespace

TileBounds boundTile(const GridTile& tile, const VectorArray& x) {
  TileBounds bounds;
  boundCells(tile, axesAt(x, 0), bounds);
  return bounds;
}

TileBounds boundCell(const GridTile& tile, const VectorArray& x) {
  const Vec3 corners[4] = {x.at(tile.first), x.at(tile.first + 1), x.at(tile.first + tile.stride),
                           x.at(tile.first + tile.stride + 1)};
  TileBounds bounds;
  for (const Vec3& corner : corners) bounds.box.add({corner, corner});
  const Gradient first{(corners[1] - corners[0]) / tile.cell.x(),
                       (corners[2] - corners[0]) / tile.cell.y()};
  const Gradient last{(corners[3] - corners[2]) / tile.cell.x(),
                      (corners[3] - corners[1]) / tile.cell.y()};
  // The middle of both is as far from the gradients of the faces, which mix their columns.
  bounds.ball.centre = {0.5 * (first.u + last.u), 0.5 * (first.v + last.v)};
  bounds.ball.radius = 0.5 * (last - first).norm();
  return bounds;
}

}  // namespace cloth_sim
