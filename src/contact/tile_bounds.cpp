#include "tile_bounds.h"

#include <algorithm>
#include <array>

#include "closest_lanes.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

/// Groups of faces that get a ball together.
constexpr std::int32_t kMostGroups = 16;

/// Gradients of four faces.
struct GradientLanes {
  Lanes3 u;
  Lanes3 v;
};

[[gnu::always_inline]] inline Lanes lower(const Lanes& a, const Lanes& b) { return a < b ? a : b; }
[[gnu::always_inline]] inline Lanes upper(const Lanes& a, const Lanes& b) { return a > b ? a : b; }

using Corners = std::array<Lanes3, 3>;

[[gnu::always_inline]] inline Corners cornersOf(const FaceLanes& faces, const ConstAxes& x) {
  return {gather(x, faces.corners[0]), gather(x, faces.corners[1]), gather(x, faces.corners[2])};
}

[[gnu::always_inline]] inline Lanes3 lanesFrom(const ConstAxes& x, std::int32_t first) {
  return {lanesAt(x.x + first), lanesAt(x.y + first), lanesAt(x.z + first)};
}

[[gnu::always_inline]] inline Corners cornersOf(const FaceRun& run, const ConstAxes& x) {
  return {lanesFrom(x, run.corners[0]), lanesFrom(x, run.corners[1]), lanesFrom(x, run.corners[2])};
}

[[gnu::always_inline]] inline Lanes widen(const float* of) {
  return Lanes{of[0], of[1], of[2], of[3]};
}
[[gnu::always_inline]] inline Lanes widen(float of) { return Lanes{} + of; }

/// \param inverse  of the edges at rest, row by row: for each face, or for all.
template <typename Inverse>
[[gnu::always_inline]] inline GradientLanes gradientsOf(const Corners& at, const Inverse& inverse) {
  const Lanes3 first = at[1] - at[0];
  const Lanes3 second = at[2] - at[0];
  return {widen(inverse[0]) * first + widen(inverse[2]) * second,
          widen(inverse[1]) * first + widen(inverse[3]) * second};
}

/// A box that grows, in four lanes.
struct BoxLanes {
  Lanes3 low = {Lanes{} + 1e300, Lanes{} + 1e300, Lanes{} + 1e300};
  Lanes3 high = {Lanes{} - 1e300, Lanes{} - 1e300, Lanes{} - 1e300};
};

[[gnu::always_inline]] inline void add(const Corners& corners, BoxLanes& box) {
  for (const Lanes3& at : corners) {
    box.low = {lower(at.x, box.low.x), lower(at.y, box.low.y), lower(at.z, box.low.z)};
    box.high = {upper(at.x, box.high.x), upper(at.y, box.high.y), upper(at.z, box.high.z)};
  }
}

[[gnu::always_inline]] inline double leastOf(const Lanes& of) {
  return std::min(std::min(of[0], of[1]), std::min(of[2], of[3]));
}
[[gnu::always_inline]] inline double mostOf(const Lanes& of) {
  return std::max(std::max(of[0], of[1]), std::max(of[2], of[3]));
}

[[gnu::always_inline]] inline Box boxOf(const BoxLanes& box) {
  return {{leastOf(box.low.x), leastOf(box.low.y), leastOf(box.low.z)},
          {mostOf(box.high.x), mostOf(box.high.y), mostOf(box.high.z)}};
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

/// The ball around the mean of the gradients of at most kMostGroups groups of faces, which a box
/// grows by.
template <typename Group>
[[gnu::always_inline]] inline GradientBall ballOf(const Group* faces, std::int32_t groups,
                                                  const ConstAxes& x, BoxLanes& box) {
  GradientLanes each[kMostGroups];
  GradientLanes sum{};
  for (std::int32_t k = 0; k < groups; ++k) {
    const Corners corners = cornersOf(faces[k], x);
    add(corners, box);
    each[k] = gradientsOf(corners, faces[k].inverseRest);
    sum.u = sum.u + each[k].u;
    sum.v = sum.v + each[k].v;
  }
  GradientBall ball;
  ball.centre = {meanOf(sum.u, groups), meanOf(sum.v, groups)};
  const GradientLanes centre{lanesOf(ball.centre.u), lanesOf(ball.centre.v)};
  Lanes most{};
  for (std::int32_t k = 0; k < groups; ++k) {
    const Lanes3 u = each[k].u - centre.u;
    const Lanes3 v = each[k].v - centre.v;
    most = upper(dot(u, u) + dot(v, v), most);
  }
  ball.radius = std::sqrt(mostOf(most));
  return ball;
}

template <typename Group>
[[gnu::always_inline]] inline void addFaces(const Group* faces, std::int32_t groups,
                                            const ConstAxes& x, BoxLanes& box, GradientBall& ball) {
  for (std::int32_t first = 0; first < groups; first += kMostGroups) {
    ball.add(ballOf(faces + first, std::min(kMostGroups, groups - first), x, box));
  }
}

CLOTH_SIM_VECTOR_CLONES
void boundFaces(const Tile& tile, const ConstAxes& x, TileBounds& bounds) {
  BoxLanes box;
  addFaces(tile.runs, tile.runCount, x, box, bounds.ball);
  addFaces(tile.faces, tile.groupCount, x, box, bounds.ball);
  bounds.box = boxOf(box);
}

}  // namespace

TileBounds boundTile(const Tile& tile, const ConstAxes& x) {
  TileBounds bounds;
  boundFaces(tile, x, bounds);
  return bounds;
}

}  // namespace cloth_sim
