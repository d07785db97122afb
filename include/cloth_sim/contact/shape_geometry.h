#pragma once
/// \file Geometry that several shapes share: sweeps against convex solids, and the axes of boxes.

#include <algorithm>

#include "cloth_sim/contact/shape_contract.h"

namespace cloth_sim::geometry {

/// Tolerance of the distance between an entry point and the surface [m]. It moves the end of the
/// particle by its square only.
constexpr double kEntryTolerance = 1e-9;
constexpr int kMaxEntryIterations = 48;

/// `sweep` of a path that starts inside a convex solid. The gap of a convex solid is convex, so it
/// is nowhere less than its tangent at the start: a bound on the tangent is a bound on the gap.
/// \param gap     at the start [m].
/// \param normal  at the start.
template <class Convex>
bool sweepFromInside(const Convex& solid, const Vec3& start, const Vec3& end, double rise,
                     double gap, const Vec3& normal, SweepHit& hit) {
  const double moved = normal.dot(end - start);
  if (moved >= 0.0 && solid.gap(end) >= 0.0) return false;  // it leaves without help
  hit.normal = normal;
  hit.push = std::min(0.0, gap + rise) - (gap + moved);
  return hit.push > 0.0;
}

/// `sweep` for every convex solid. Newton's method finds the entry point, the first root of the gap
/// along the path. The gap is convex along the path, so the iterates approach the root from the
/// start and cannot step over it, however thin the solid or fast the particle.
template <class Convex>
[[gnu::noinline]] bool sweepConvex(const Convex& solid, const Vec3& start, const Vec3& end,
                                   double rise, SweepHit& hit) {
  Vec3 normal;
  double gap = solid.gap(start, normal);
  if (gap < 0.0) return sweepFromInside(solid, start, end, rise, gap, normal, hit);

  const Vec3 path = end - start;
  double slope = normal.dot(path);
  double t = 0.0;
  for (int i = 0; i < kMaxEntryIterations && gap > kEntryTolerance; ++i) {
    if (slope >= 0.0) return false;  // past the nearest point
    t -= gap / slope;
    if (t > 1.0) return false;
    gap = solid.gap(start + t * path, normal);
    slope = normal.dot(path);
  }
  hit.normal = normal;
  hit.push = -(gap + (1.0 - t) * slope);
  return hit.push > 0.0;
}

/// The same for solids whose gap is a distance: first tests whether the path is long enough to get
/// there.
template <class Convex>
[[gnu::always_inline]] inline bool sweepNearConvex(const Convex& solid, const Vec3& start,
                                                   const Vec3& end, double rise, SweepHit& hit) {
  const double length2 = (end - start).squaredNorm();
  const double before = solid.gap(start);
  if (before >= 0.0 && before * before >= length2) return false;
  return sweepConvex(solid, start, end, rise, hit);
}

/// Axes of an upright box: those of the world, so nothing to compute.
struct WorldAxes {
  static constexpr bool kUpright = true;

  const Vec3& toLocal(const Vec3& world) const { return world; }
  Vec3 toWorld(const Vec3& local) const { return local; }
  const Vec3& extent(const Vec3& half) const { return half; }
};

/// Axes of a rotated box.
struct RotatedAxes {
  static constexpr bool kUpright = false;

  explicit RotatedAxes(const Quat& orientation)
      : matrix(orientation.toRotationMatrix().transpose()) {}

  Vec3 toLocal(const Vec3& world) const { return matrix * world; }
  Vec3 toWorld(const Vec3& local) const { return matrix.transpose() * local; }
  /// Half edge lengths, along these axes, of the bounding box of a box along the axes of the world.
  Vec3 extent(const Vec3& half) const { return matrix.cwiseAbs() * half; }

  Eigen::Matrix3d matrix;  ///< (3 x 3) rotates from the world to the box
};

/// Calls `function` with `Solid<WorldAxes>` or `Solid<RotatedAxes>`, as the orientation asks.
/// \param size  edge lengths [m].
template <template <class> class Solid, class Function>
decltype(auto) visitAxes(const Vec3& size, const Quat& orientation, double margin,
                         Function&& function) {
  if (orientation.vec().isZero(0.0)) return function(Solid<WorldAxes>({}, size, margin));
  return function(Solid<RotatedAxes>(RotatedAxes(orientation), size, margin));
}

}  // namespace cloth_sim::geometry
