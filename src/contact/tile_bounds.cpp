#include "tile_bounds.h"

#include <algorithm>

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

[[gnu::always_inline]] inline Lanes widen(const float* of) {
  return Lanes{of[0], of[1], of[2], of[3]};
}

[[gnu::always_inline]] inline GradientLanes gradientsOf(const FaceLanes& faces,
                                                        const ConstAxes& x) {
  const Lanes3 at = gather(x, faces.corners[0]);
  const Lanes3 first = gather(x, faces.corners[1]) - at;
  const Lanes3 second = gather(x, faces.corners[2]) - at;
  const auto& inverse = faces.inverseRest;
  return {widen(inverse[0]) * first + widen(inverse[2]) * second,
          widen(inverse[1]) * first + widen(inverse[3]) * second};
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

/// The ball around the mean of the gradients of at most kMostGroups groups of faces.
[[gnu::always_inline]] inline GradientBall ballOf(const FaceLanes* faces, std::int32_t groups,
                                                  const ConstAxes& x) {
  GradientLanes each[kMostGroups];
  GradientLanes sum = each[0] = gradientsOf(faces[0], x);
  for (std::int32_t k = 1; k < groups; ++k) {
    each[k] = gradientsOf(faces[k], x);
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
  ball.radius = std::sqrt(std::max({most[0], most[1], most[2], most[3]}));
  return ball;
}

/// Adds the ball of the faces to an empty one.
CLOTH_SIM_VECTOR_CLONES
void boundGradients(const Tile& tile, const ConstAxes& x, GradientBall& ball) {
  for (std::int32_t first = 0; first < tile.groupCount; first += kMostGroups) {
    ball.add(ballOf(tile.faces + first, std::min(kMostGroups, tile.groupCount - first), x));
  }
}

CLOTH_SIM_VECTOR_CLONES
void boundAxis(const Tile& tile, const double* x, double& least, double& most) {
  Lanes low = gather(x, tile.vertices);
  Lanes high = low;
  for (std::int32_t k = kLanes; k < tile.vertexCount; k += kLanes) {
    const Lanes at = gather(x, tile.vertices + k);
    low = lower(at, low);
    high = upper(at, high);
  }
  least = std::min({low[0], low[1], low[2], low[3]});
  most = std::max({high[0], high[1], high[2], high[3]});
}

}  // namespace

TileBounds boundTile(const Tile& tile, const ConstAxes& x) {
  TileBounds bounds;
  boundAxis(tile, x.x, bounds.box.low.x(), bounds.box.high.x());
  boundAxis(tile, x.y, bounds.box.low.y(), bounds.box.high.y());
  boundAxis(tile, x.z, bounds.box.low.z(), bounds.box.high.z());
  boundGradients(tile, x, bounds.ball);
  return bounds;
}

}  // namespace cloth_sim
