#pragma once
/// \file The shapes of obstacles as geometry: signed distances, normals, and where a path is
/// stopped.
///
/// All points are relative to the obstacle's position, in the world's axes. A `gap` is the signed
/// distance to the surface less the margin, so every solid is its shape inflated by a ball of that
/// radius: a box has round edges and its normals turn continuously. Each geometry has
///
///     double gap(p)                      signed [m]
///     double gap(p, normal)              and the unit vector in which it grows fastest
///     double leastGap(centre, half)      a lower bound on `gap` over an axis-aligned box
///     bool beyond(p, d)                  a cheap test; true only if gap(p) > d
///     bool touch(start, end, rise, t)    whether the path from start to end is stopped
///     optional<Top> top()                the level top, if there is one
///     kSides                             how many times a path can be stopped in one substep
///
/// `touch` says along which normal, and how far, the end has to move. A path that starts outside
/// (gap >= 0) is held to the plane that touches the solid where it enters. A path that starts
/// inside is moved out the shortest way from its start, by `rise` at most, and never let deeper.
/// `touch` is inlined into the loop over particles by force: called, it would spend as long passing
/// vectors through memory as computing.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include "cloth_sim/contact/collider.h"

namespace cloth_sim::geometry {

struct Touch {
  Vec3 normal = Vec3::UnitZ();
  double push = 0.0;  ///< by which the end of the path must move along the normal [m], > 0
};

/// The level top of a solid, where it has one.
struct Top {
  double halfX = 0.0;  ///< half its extent along the world's x [m]
  double halfY = 0.0;  ///< and y [m]
  double solid = 0.0;  ///< its height over the obstacle's position [m]
  double level = 0.0;  ///< the same plus the margin [m]
};

/// How far from a convex solid's surface its entry point may be when the search for it ends. The
/// error in where the particle ends is of second order in this.
constexpr double kEntryTolerance = 1e-9;  // [m]
constexpr int kMaxEntryIterations = 48;

/// `touch` for a path that starts inside a convex solid: `gap` and `normal` are the start's.
/// The gap of a convex solid is convex, so it is at least what its tangent at the start says: to
/// hold the tangent to a level holds the gap to it.
template <class Convex>
bool touchFromInside(const Convex& solid, const Vec3& start, const Vec3& end, double rise,
                     double gap, const Vec3& normal, Touch& touch) {
  const double moved = normal.dot(end - start);
  if (moved >= 0.0 && solid.gap(end) >= 0.0) return false;  // leaves by itself
  touch.normal = normal;
  touch.push = std::min(0.0, gap + rise) - (gap + moved);
  return touch.push > 0.0;
}

/// `touch` for any convex solid. The entry is found by Newton's method on the gap along the path:
/// as that is convex, the iteration comes from the left and cannot step over the first root,
/// however thin the solid or fast the particle.
template <class Convex>
[[gnu::noinline]] bool touchConvex(const Convex& solid, const Vec3& start, const Vec3& end,
                                   double rise, Touch& touch) {
  Vec3 normal;
  double gap = solid.gap(start, normal);
  if (gap < 0.0) return touchFromInside(solid, start, end, rise, gap, normal, touch);

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
  touch.normal = normal;
  touch.push = -(gap + (1.0 - t) * slope);
  return touch.push > 0.0;
}

/// Everything below a plane through the origin.
class Plane {
 public:
  static constexpr int kSides = 1;

  Plane(const Vec3& normal, double margin) : normal_(normal), margin_(margin) {}

  double gap(const Vec3& p) const { return normal_.dot(p) - margin_; }
  double gap(const Vec3& p, Vec3& normal) const {
    normal = normal_;
    return gap(p);
  }
  double leastGap(const Vec3& centre, const Vec3& half) const {
    return gap(centre) - normal_.cwiseAbs().dot(half);
  }
  bool beyond(const Vec3& p, double distance) const { return gap(p) > distance; }

  [[gnu::always_inline]] bool touch(const Vec3& start, const Vec3& end, double rise,
                                    Touch& touch) const {
    const double after = gap(end);
    if (after >= 0.0) return false;
    touch.normal = normal_;
    touch.push = std::min(0.0, gap(start) + rise) - after;
    return touch.push > 0.0;
  }

  std::optional<Top> top() const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (normal_ != Vec3::UnitZ()) return std::nullopt;
    return Top{kInfinity, kInfinity, -kInfinity, margin_};
  }

 private:
  Vec3 normal_;
  double margin_;
};

/// A ball around the origin.
class Sphere {
 public:
  static constexpr int kSides = 1;

  Sphere(double radius, double margin) : reach_(radius + margin) {}

  double gap(const Vec3& p) const { return p.norm() - reach_; }
  double gap(const Vec3& p, Vec3& normal) const {
    const double distance = p.norm();
    normal = distance > 0.0 ? Vec3(p / distance) : Vec3(Vec3::UnitZ());
    return distance - reach_;
  }
  double leastGap(const Vec3& centre, const Vec3& half) const {
    return (centre.cwiseAbs() - half).cwiseMax(0.0).norm() - reach_;
  }
  bool beyond(const Vec3& p, double distance) const {
    const double limit = reach_ + distance;
    return limit < 0.0 || p.squaredNorm() > limit * limit;
  }

  [[gnu::always_inline]] bool touch(const Vec3& start, const Vec3& end, double rise,
                                    Touch& touch) const {
    return !misses(start, end) && touchConvex(*this, start, end, rise, touch);
  }

  std::optional<Top> top() const { return std::nullopt; }

 private:
  /// Ends outside and has not come nearer on the way than the radius; exact, without a root.
  bool misses(const Vec3& start, const Vec3& end) const {
    const double radius2 = reach_ * reach_;
    if (end.squaredNorm() < radius2) return false;
    const Vec3 path = end - start;
    const double length2 = path.squaredNorm();
    const double along = -start.dot(path);  // times length2: where the path is nearest
    if (along <= 0.0 || along >= length2) return true;
    return start.squaredNorm() * length2 - along * along >= radius2 * length2;
  }

  double reach_;
};

/// All points nearer than a radius to a segment around the origin.
class Capsule {
 public:
  static constexpr int kSides = 1;

  /// \param axis  unit vector along the segment.
  Capsule(const Vec3& axis, double length, double radius, double margin)
      : axis_(axis), half_(0.5 * length), reach_(radius + margin) {}

  double gap(const Vec3& p) const { return fromSegment(p).norm() - reach_; }
  double gap(const Vec3& p, Vec3& normal) const {
    const Vec3 away = fromSegment(p);
    const double distance = away.norm();
    normal = distance > kOnAxis ? Vec3(away / distance) : axis_.unitOrthogonal();
    return distance - reach_;
  }
  /// The gap grows by no more than the way.
  double leastGap(const Vec3& centre, const Vec3& half) const { return gap(centre) - half.norm(); }
  bool beyond(const Vec3& p, double distance) const {
    const double limit = reach_ + distance;
    return limit < 0.0 || fromSegment(p).squaredNorm() > limit * limit;
  }

  [[gnu::always_inline]] bool touch(const Vec3& start, const Vec3& end, double rise,
                                    Touch& touch) const {
    const double way2 = (end - start).squaredNorm();
    const double before = gap(start);
    if (before >= 0.0 && before * before >= way2) return false;  // too far away to get there
    return touchConvex(*this, start, end, rise, touch);
  }

  std::optional<Top> top() const { return std::nullopt; }

 private:
  static constexpr double kOnAxis = 1e-12;  ///< nearer than this, round-off points anywhere [m]

  /// From the nearest point of the segment.
  Vec3 fromSegment(const Vec3& p) const {
    return p - std::clamp(axis_.dot(p), -half_, half_) * axis_;
  }

  Vec3 axis_;
  double half_;
  double reach_;
};

/// The axes of a shape that stands as the world does: nothing to compute.
struct WorldAxes {
  const Vec3& toLocal(const Vec3& world) const { return world; }
  Vec3 toWorld(const Vec3& local) const { return local; }
  const Vec3& extent(const Vec3& half) const { return half; }
};

/// The axes of a shape that is turned.
struct TurnedAxes {
  explicit TurnedAxes(const Quat& orientation)
      : matrix(orientation.toRotationMatrix().transpose()) {}

  Vec3 toLocal(const Vec3& world) const { return matrix * world; }
  Vec3 toWorld(const Vec3& local) const { return matrix.transpose() * local; }
  /// Half edge lengths, along these axes, around a box along the world's.
  Vec3 extent(const Vec3& half) const { return matrix.cwiseAbs() * half; }

  Eigen::Matrix3d matrix;  ///< takes directions of the world to the shape's axes
};

/// A solid box around the origin.
template <class Axes>
class Box {
 public:
  static constexpr int kSides = 1;

  Box(const Axes& axes, const Vec3& size, double margin)
      : axes_(axes), half_(0.5 * size), margin_(margin) {}

  double gap(const Vec3& p) const {
    const Vec3 excess = excessOf(axes_.toLocal(p));
    const double inside = excess.maxCoeff();
    return (inside <= 0.0 ? inside : excess.cwiseMax(0.0).norm()) - margin_;
  }

  double gap(const Vec3& p, Vec3& normal) const {
    const Vec3 local = axes_.toLocal(p);
    const Vec3 excess = excessOf(local);
    int face = 0;
    double distance = excess.maxCoeff(&face);
    Vec3 outward = Vec3::Zero();
    if (distance > 0.0) {  // the feature is the face, edge or corner beyond which the point lies
      outward = excess.cwiseMax(0.0);
      distance = outward.norm();
      outward /= distance;
    } else {
      outward[face] = 1.0;
    }
    for (int k = 0; k < 3; ++k) outward[k] = std::copysign(outward[k], local[k]);
    normal = axes_.toWorld(outward);
    return distance - margin_;
  }

  /// The box's own axes as separating axes; the bound is loose for boxes that are turned.
  double leastGap(const Vec3& centre, const Vec3& half) const {
    const Vec3 excess = axes_.toLocal(centre).cwiseAbs() - axes_.extent(half) - half_;
    return excess.maxCoeff() - margin_;
  }
  bool beyond(const Vec3& p, double distance) const {
    return excessOf(axes_.toLocal(p)).maxCoeff() > margin_ + distance;
  }

  [[gnu::always_inline]] bool touch(const Vec3& start, const Vec3& end, double rise,
                                    Touch& touch) const {
    const Vec3 to = axes_.toLocal(end);
    const Vec3 from = axes_.toLocal(start);
    if (misses<2>(from, to)) return false;  // first: most boards are tables
    // Mostly the path stays over one face, and the box is a plane.
    const Vec3 besideFrom = excessOf(from);
    const Vec3 besideTo = excessOf(to);
    if (isOver<2>(besideFrom, besideTo)) return touchFace<2>(from, to, rise, touch);
    if (misses<0>(from, to) || misses<1>(from, to)) return false;
    if (isOver<1>(besideFrom, besideTo)) return touchFace<1>(from, to, rise, touch);
    if (isOver<0>(besideFrom, besideTo)) return touchFace<0>(from, to, rise, touch);
    return touchConvex(*this, start, end, rise, touch);
  }

  std::optional<Top> top() const {
    if (!std::is_same_v<Axes, WorldAxes>) return std::nullopt;
    return Top{half_.x(), half_.y(), half_.z(), half_.z() + margin_};
  }

 private:
  /// By how much a local point lies beyond each pair of faces [m].
  Vec3 excessOf(const Vec3& local) const { return local.cwiseAbs() - half_; }

  /// Both ends lie beyond the same one of the two faces across the axis.
  template <int axis>
  bool misses(const Vec3& from, const Vec3& to) const {
    const double limit = half_[axis] + margin_;
    return (from[axis] >= limit && to[axis] >= limit) ||
           (from[axis] <= -limit && to[axis] <= -limit);
  }

  /// Whether the closest feature to the start is a face across the axis, and the path stays over
  /// it. Both arguments are from `excessOf`.
  template <int axis>
  static bool isOver(const Vec3& from, const Vec3& to) {
    constexpr int a = (axis + 1) % 3;
    constexpr int b = (axis + 2) % 3;
    const double most = std::min(0.0, from[axis]);
    return from[a] <= most && from[b] <= most && to[a] <= 0.0 && to[b] <= 0.0;
  }

  /// `touch` for a path over a face; in local coordinates.
  template <int axis>
  bool touchFace(const Vec3& from, const Vec3& to, double rise, Touch& touch) const {
    const double side = std::copysign(1.0, from[axis]);
    const double level = half_[axis] + margin_;
    const double after = side * to[axis] - level;
    if (after >= 0.0) return false;
    touch.normal = axes_.toWorld(side * Vec3::Unit(axis));
    touch.push = std::min(0.0, side * from[axis] - level + rise) - after;
    return touch.push > 0.0;
  }

  Axes axes_;
  Vec3 half_;
  double margin_;
};

/// The outside of a box around the origin.
template <class Axes>
class Bounds {
 public:
  static constexpr int kSides = 3;

  Bounds(const Axes& axes, const Vec3& size, double margin)
      : axes_(axes), half_(0.5 * size), margin_(margin), room_((half_.array() - margin).max(0.0)) {}

  double gap(const Vec3& p) const {
    const Vec3 excess = axes_.toLocal(p).cwiseAbs() - half_;
    const double outside = excess.maxCoeff();
    return -(outside <= 0.0 ? outside : excess.cwiseMax(0.0).norm()) - margin_;
  }
  double gap(const Vec3& p, Vec3& normal) const {
    const Vec3 local = axes_.toLocal(p);
    const Vec3 excess = local.cwiseAbs() - half_;
    int face = 0;
    Vec3 inward = Vec3::Zero();
    if (excess.maxCoeff(&face) > 0.0) {
      inward = excess.cwiseMax(0.0).normalized();
    } else {
      inward[face] = 1.0;
    }
    for (int k = 0; k < 3; ++k) inward[k] = -std::copysign(inward[k], local[k]);
    normal = axes_.toWorld(inward);
    return gap(p);
  }
  double leastGap(const Vec3& centre, const Vec3& half) const {
    const Vec3 excess = axes_.toLocal(centre).cwiseAbs() + axes_.extent(half) - half_;
    const double outside = excess.maxCoeff();
    return -(outside <= 0.0 ? outside : excess.cwiseMax(0.0).norm()) - margin_;
  }
  bool beyond(const Vec3& p, double distance) const { return gap(p) > distance; }

  /// The wall that the end lies farthest behind. The room inside is convex, so whatever the other
  /// walls and friction do later, a wall that has been dealt with is not entered again.
  [[gnu::always_inline]] bool touch(const Vec3& start, const Vec3& end, double rise,
                                    Touch& touch) const {
    const Vec3 to = axes_.toLocal(end);
    if ((to.cwiseAbs() - room_).maxCoeff() <= 0.0) return false;
    const Vec3 from = axes_.toLocal(start);
    const Vec3 limit = room_.cwiseMax(from.cwiseAbs() - Vec3::Constant(rise));
    int wall = 0;
    const double push = (to.cwiseAbs() - limit).maxCoeff(&wall);
    if (!(push > 0.0)) return false;
    touch.normal = axes_.toWorld(std::copysign(1.0, -to[wall]) * Vec3::Unit(wall));
    touch.push = push;
    return true;
  }

  std::optional<Top> top() const { return std::nullopt; }

 private:
  Axes axes_;
  Vec3 half_;
  double margin_;
  Vec3 room_;  ///< where particles may be: half edge lengths [m]
};

/// Calls `function` with a box or bounds in the axes that suit the orientation.
template <template <class> class Solid, class Function>
decltype(auto) visitTurned(const Vec3& size, const Quat& orientation, double margin,
                           Function&& function) {
  if (orientation.vec().isZero(0.0)) return function(Solid<WorldAxes>({}, size, margin));
  return function(Solid<TurnedAxes>(TurnedAxes(orientation), size, margin));
}

/// Calls `function` with the geometry of the collider: the choice by shape is made here, once,
/// and not in the function's loop over particles.
template <class Function>
decltype(auto) visit(const Collider& collider, double margin, Function&& function) {
  const Quat& orientation = collider.obstacle().pose.orientation;
  const Shape& shape = collider.obstacle().shape;
  if (const auto* board = std::get_if<BoxShape>(&shape)) {
    return visitTurned<Box>(board->size, orientation, margin, function);
  }
  if (const auto* bounds = std::get_if<BoundsShape>(&shape)) {
    return visitTurned<Bounds>(bounds->size, orientation, margin, function);
  }
  if (const auto* sphere = std::get_if<SphereShape>(&shape)) {
    return function(Sphere(sphere->radius, margin));
  }
  if (const auto* capsule = std::get_if<CapsuleShape>(&shape)) {
    return function(Capsule(orientation * Vec3::UnitZ(), capsule->length, capsule->radius, margin));
  }
  return function(Plane(orientation * Vec3::UnitZ(), margin));
}

/// The same with the largest margin of any cloth.
template <class Function>
decltype(auto) visit(const Collider& collider, Function&& function) {
  return visit(collider, collider.margin(), std::forward<Function>(function));
}

}  // namespace cloth_sim::geometry
