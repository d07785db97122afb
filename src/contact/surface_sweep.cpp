#include <algorithm>
#include <cmath>
#include <optional>

#include "cloth_sim/contact/shape_geometry.h"
#include "cloth_sim/contact/triangle_surface.h"

namespace cloth_sim {
namespace {

constexpr double kPushRoundOff = 1e-13;  ///< pushes below it are round-off [m]

/// Tells whether a segment comes into a box: each axis of the box limits its part inside.
bool meetsBox(const Vec3& from, const Vec3& path, const Vec3& low, const Vec3& high) {
  double first = 0.0;
  double last = 1.0;
  for (int k = 0; k < 3; ++k) {
    if (path[k] == 0.0) {
      if (from[k] < low[k] || from[k] > high[k]) return false;
      continue;
    }
    const double a = (low[k] - from[k]) / path[k];
    const double b = (high[k] - from[k]) / path[k];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first <= last;
}

/// `push` of a path over a face, as far as it begins within reach of it.
double pushAtFace(double gap, double slope, double rise) {
  const double left = gap < 0.0 ? std::min(0.0, gap + rise) : 0.0;
  return left - (gap + slope);
}

bool hasVertex(const TriangleSurface::Triangle& triangle, std::int32_t vertex) {
  return triangle[0] == vertex || triangle[1] == vertex || triangle[2] == vertex;
}

}  // namespace

/// Finds where the paths of a particle are stopped by a surface.
class SurfaceSweep {
 public:
  /// \param reach, rise  see TriangleSurface::sweep [m].
  SurfaceSweep(const TriangleSurface& surface, double reach, double rise, NearTriangles& near)
      : surface_(surface), reach_(reach), rise_(rise), near_(near) {}

  bool run(const Vec3& from, const Vec3& to, SurfaceHit& hit);

 private:
  void fill(const Vec3& from, const Vec3& to);
  bool list();
  std::optional<bool> sideNearby(const Vec3& p, double within) const;
  bool stopsAtFace(const TriangleSurface::Flat& flat, const Vec3& from, const Vec3& path,
                   bool& isInFront, SurfaceHit& hit) const;
  bool stopsInside(const Vec3& from, const Vec3& to, SurfaceHit& hit) const;
  bool meets(std::int32_t triangle, const Vec3& from, const Vec3& to, SurfaceHit& hit,
             TrianglePoint& at) const;
  bool isBesideNearer(const TrianglePoint& at, const Vec3& p) const;
  template <class Function>
  void visitNear(const Vec3& from, const Vec3& to, double reach, Function&& function) const;

  const TriangleSurface& surface_;
  const double reach_;
  const double rise_;
  NearTriangles& near_;
};

/// Most contacts: whether a path begins within reach of a face, stays over it and is stopped by it.
/// Another triangle that the path meets as early is found once this one has been dealt with.
/// \param isInFront  set if the path begins within reach of the outer side of the face.
bool SurfaceSweep::stopsAtFace(const TriangleSurface::Flat& flat, const Vec3& from,
                               const Vec3& path, bool& isInFront, SurfaceHit& hit) const {
  const Vec3 start = from - flat.corner;
  const double before = flat.normal.dot(start);
  const double height = surface_.isClosed_ ? before : std::abs(before);
  if (height > reach_ + geometry::kEntryTolerance || height < TriangleSurface::kNoDistance)
    return false;
  if (!flat.isOver(start)) return false;
  isInFront = true;
  const double side = before > 0.0 ? 1.0 : -1.0;
  const double push = pushAtFace(height - reach_, side * flat.normal.dot(path), rise_);
  if (!(push > kPushRoundOff) || !flat.isOver(start + path)) return false;
  hit.at = std::min(0.0, height - reach_);
  hit.normal = side * flat.normal;
  hit.push = push;
  return true;
}

/// Calls `function` with each triangle that a part of the path may come nearer to than `reach`, and
/// with others.
template <class Function>
void SurfaceSweep::visitNear(const Vec3& from, const Vec3& to, double reach,
                             Function&& function) const {
  if (near_.count != kNone) {
    for (std::int32_t k = 0; k < near_.count; ++k) function(near_.triangles[k]);
    return;
  }
  const Vec3 path = to - from;
  const Vec3 room = Vec3::Constant(reach + 2.0 * geometry::kEntryTolerance);
  visitLeaves(
      surface_.nodes_,
      [&](const BoxNode& node) { return meetsBox(from, path, node.low - room, node.high + room); },
      function);
}

/// Lists the triangles around a path, if the list does not have them yet.
void SurfaceSweep::fill(const Vec3& from, const Vec3& to) {
  const double farthest = std::max((from - near_.centre).cwiseAbs().maxCoeff(),
                                   (to - near_.centre).cwiseAbs().maxCoeff());
  if (farthest <= near_.half) return;
  near_.centre = 0.5 * (from + to);
  const double path = 0.5 * (to - from).cwiseAbs().maxCoeff();
  bool fits = false;
  for (const double pad : {surface_.pad_, 0.125 * surface_.pad_}) {
    near_.half = path + pad;
    fits = list();
    if (fits) break;
  }
  if (!fits) near_.half = -1.0;  // only this path may use it
  if (near_.count != 0) {
    if (!surface_.isClosed_) return;
    const std::optional<bool> side = sideNearby(from, reach_ + 0.125 * surface_.pad_);
    near_.isInside = side ? *side : surface_.distance(from) < 0.0;
    return;
  }
  const double away = surface_.distance(from);
  near_.isInside = away < 0.0;
  // The box in the ball that is free of triangles may be larger.
  const double free = 0.577 * (std::abs(away) - reach_ - 2.0 * geometry::kEntryTolerance);
  if (free <= near_.half) return;
  near_.centre = from;
  near_.half = free;
}

/// Tells whether a point is inside the closed surface, if a triangle is nearer than `within`; the
/// list must have all of those.
std::optional<bool> SurfaceSweep::sideNearby(const Vec3& p, double within) const {
  TrianglePoint nearest;
  nearest.distance = within;
  visitNear(p, p, within, [&](std::int32_t t) {
    const double height = surface_.flats_[t].normal.dot(p - surface_.flats_[t].corner);
    if (std::abs(height) >= nearest.distance) return;
    const TrianglePoint at = surface_.closestOf(t, p);
    if (at.distance < nearest.distance) nearest = at;
  });
  if (nearest.triangle == kNone) return std::nullopt;
  return (p - nearest.point).dot(surface_.pseudonormal(nearest)) < 0.0;
}

/// Lists the triangles in reach of the box. \return false, and no list, if there are too many.
bool SurfaceSweep::list() {
  near_.count = 0;
  const Vec3 room = Vec3::Constant(near_.half + reach_ + 2.0 * geometry::kEntryTolerance);
  const Vec3 low = near_.centre - room;
  const Vec3 high = near_.centre + room;
  const auto overlaps = [&](const Vec3& least, const Vec3& most) {
    return boxesMeet(least, most, low, high);
  };
  const auto isNear = [&](const BoxNode& node) {
    return near_.count != kNone && overlaps(node.low, node.high);
  };
  visitLeaves(surface_.nodes_, isNear, [&](std::int32_t t) {
    if (near_.count == kNone) return;
    const std::array<Vec3, 3> x = surface_.cornersOf(t);
    if (!overlaps(x[0].cwiseMin(x[1]).cwiseMin(x[2]), x[0].cwiseMax(x[1]).cwiseMax(x[2]))) return;
    const double side = surface_.flats_[t].normal.dot(near_.centre - x[0]);
    if (std::abs(side) > surface_.flats_[t].normal.cwiseAbs().dot(room)) return;
    const bool isFull = near_.count == NearTriangles::kMost;
    if (!isFull) near_.triangles[near_.count] = t;
    near_.count = isFull ? kNone : near_.count + 1;
  });
  return near_.count != kNone;
}

/// `sweep` of a path that begins inside a closed surface.
bool SurfaceSweep::stopsInside(const Vec3& from, const Vec3& to, SurfaceHit& hit) const {
  const double gap = surface_.distance(from, hit.normal) - reach_;
  const double moved = hit.normal.dot(to - from);
  if (moved >= 0.0 && surface_.distance(to) >= reach_) return false;  // it leaves without help
  hit.at = gap;
  hit.push = std::min(0.0, gap + rise_) - (gap + moved);
  return hit.push > kPushRoundOff;
}

/// Tells whether one triangle stops the path. The distance to a triangle is convex, so Newton's
/// method finds where the path comes within reach, as in `sweepConvex`. \param at  the closest
/// point of the triangle there.
bool SurfaceSweep::meets(std::int32_t triangle, const Vec3& from, const Vec3& to, SurfaceHit& hit,
                         TrianglePoint& at) const {
  const TriangleSurface::Flat& flat = surface_.flats_[triangle];
  const double before = flat.normal.dot(from - flat.corner);
  const double after = flat.normal.dot(to - flat.corner);
  if ((before > reach_ && after > reach_) || (before < -reach_ && after < -reach_)) return false;
  const Vec3 path = to - from;
  const double limit = reach_ + path.norm();
  const double beside2 = flat.leastSquareBeside(from - flat.corner);
  if (before * before + beside2 >= limit * limit) return false;  // too far away to get there
  at = surface_.closestOf(triangle, from);
  double gap = at.distance - reach_;
  if (gap >= 0.0 && gap * gap >= path.squaredNorm()) return false;  // too far away to get there
  const auto normalAt = [&](const Vec3& p) -> Vec3 {
    if (at.distance > TriangleSurface::kNoDistance) return (p - at.point) / at.distance;
    return surface_.isClosed_ || before >= 0.0 ? flat.normal : Vec3(-flat.normal);
  };
  hit.normal = normalAt(from);
  double slope = hit.normal.dot(path);
  if (gap < 0.0) {
    hit.at = gap;
    hit.push = std::min(0.0, gap + rise_) - (gap + slope);
    return hit.push > kPushRoundOff;
  }
  hit.at = 0.0;
  for (int i = 0; i < geometry::kMaxEntryIterations && gap > geometry::kEntryTolerance; ++i) {
    if (slope >= 0.0) return false;  // past the nearest point
    hit.at -= gap / slope;
    if (hit.at > 1.0) return false;
    const Vec3 p = from + hit.at * path;
    at = surface_.closestOf(triangle, p);
    gap = at.distance - reach_;
    hit.normal = normalAt(p);
    slope = hit.normal.dot(path);
  }
  hit.push = -(gap + (1.0 - hit.at) * slope);
  return hit.push > kPushRoundOff;
}

/// Tells whether the closest point `at` to `p` is on an edge or a vertex beyond which another
/// triangle is nearer: then that one stops the particle, and the edge is none on the surface.
bool SurfaceSweep::isBesideNearer(const TrianglePoint& at, const Vec3& p) const {
  std::array<std::int32_t, 3> shared{};
  int count = 0;
  for (int k = 0; k < 3; ++k) {
    if (at.weight[k] != 0.0) shared[count++] = surface_.triangles_[at.triangle][k];
  }
  if (count == 3) return false;
  bool isBeside = false;
  visitNear(p, p, reach_, [&](std::int32_t other) {
    if (isBeside || other == at.triangle) return;
    for (int k = 0; k < count; ++k) {
      if (!hasVertex(surface_.triangles_[other], shared[k])) return;
    }
    isBeside = surface_.closestOf(other, p).distance < at.distance;
  });
  return isBeside;
}

bool SurfaceSweep::run(const Vec3& from, const Vec3& to, SurfaceHit& hit) {
  fill(from, to);
  if (near_.count == 0 && !near_.isInside) return false;
  bool isInFront = false;
  bool stops = false;
  const Vec3 path = to - from;
  visitNear(from, to, reach_, [&](std::int32_t t) {
    stops = stops || stopsAtFace(surface_.flats_[t], from, path, isInFront, hit);
  });
  if (stops) return true;
  if (surface_.isClosed_ && !isInFront) {
    // The sign is that of the closest point; without one that the list must have, it is as before.
    const double left = near_.half - (from - near_.centre).cwiseAbs().maxCoeff();
    const double within = reach_ + (near_.count == kNone ? surface_.pad_ : left);
    near_.isInside = sideNearby(from, within).value_or(near_.isInside);
    if (near_.isInside) return stopsInside(from, to, hit);
  }
  hit.at = 2.0;
  SurfaceHit found;
  TrianglePoint at;
  visitNear(from, to, reach_, [&](std::int32_t t) {
    if (!meets(t, from, to, found, at) || found.at >= hit.at) return;
    const Vec3 p = from + std::max(0.0, found.at) * (to - from);
    if (!isBesideNearer(at, p)) hit = found;
  });
  return hit.at <= 1.0;
}

bool TriangleSurface::sweep(const Vec3& from, const Vec3& to, double reach, double rise,
                            NearTriangles& near, SurfaceHit& hit) const {
  return SurfaceSweep(*this, reach, rise, near).run(from, to, hit);
}

}  // namespace cloth_sim
