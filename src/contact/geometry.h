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
///     kSides                             how many times a path can be stopped in one substep
///
/// `touch` says along which normal, and how far, the end has to move. A path that starts outside
/// (gap >= 0) is held to the plane that touches the solid where it enters. A path that starts
/// inside is moved out the shortest way from its start, by `rise` at most, and never let deeper.

#include <algorithm>
#include <cmath>
#include <variant>

#include "cloth_sim/contact/collider.h"

namespace cloth_sim::geometry {

struct Touch {
  Vec3 normal = Vec3::UnitZ();
  double push = 0.0;  ///< by which the end of the path must move along the normal [m], > 0
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
bool touchConvex(const Convex& solid, const Vec3& start, const Vec3& end, double rise,
                 Touch& touch) {
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

  bool touch(const Vec3& start, const Vec3& end, double rise, Touch& touch) const {
    const double after = gap(end);
    if (after >= 0.0) return false;
    touch.normal = normal_;
    touch.push = std::min(0.0, gap(start) + rise) - after;
    return touch.push > 0.0;
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

  bool touch(const Vec3& start, const Vec3& end, double rise, Touch& touch) const {
    return !misses(start, end) && touchConvex(*this, start, end, rise, touch);
  }

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

/// A solid box around the origin.
class Box {
 public:
  static constexpr int kSides = 1;

  Box(const Vec3& size, const Quat& orientation, double margin)
      : toLocal_(orientation.toRotationMatrix().transpose()), half_(0.5 * size), margin_(margin) {}

  double gap(const Vec3& p) const {
    const Vec3 excess = excessOf(toLocal_ * p);
    const double inside = excess.maxCoeff();
    return (inside <= 0.0 ? inside : excess.cwiseMax(0.0).norm()) - margin_;
  }

  double gap(const Vec3& p, Vec3& normal) const {
    const Vec3 local = toLocal_ * p;
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
    normal = toLocal_.transpose() * outward;
    return distance - margin_;
  }

  /// The box's own axes as separating axes; the bound is loose for boxes that are turned.
  double leastGap(const Vec3& centre, const Vec3& half) const {
    const Vec3 excess = (toLocal_ * centre).cwiseAbs() - toLocal_.cwiseAbs() * half - half_;
    return excess.maxCoeff() - margin_;
  }
  bool beyond(const Vec3& p, double distance) const {
    return excessOf(toLocal_ * p).maxCoeff() > margin_ + distance;
  }

  bool touch(const Vec3& start, const Vec3& end, double rise, Touch& touch) const {
    return !misses(toLocal_ * start, toLocal_ * end) && touchConvex(*this, start, end, rise, touch);
  }

 private:
  /// By how much a local point lies beyond each pair of faces [m].
  Vec3 excessOf(const Vec3& local) const { return local.cwiseAbs() - half_; }

  /// The path's own box does not meet the inflated one. z first: most boards are tables.
  bool misses(const Vec3& start, const Vec3& end) const {
    for (int k = 2; k >= 0; --k) {
      const double limit = half_[k] + margin_;
      if (std::min(start[k], end[k]) >= limit || std::max(start[k], end[k]) <= -limit) return true;
    }
    return false;
  }

  Eigen::Matrix3d toLocal_;
  Vec3 half_;
  double margin_;
};

/// The outside of a box around the origin.
class Bounds {
 public:
  static constexpr int kSides = 3;

  Bounds(const Vec3& size, const Quat& orientation, double margin)
      : toLocal_(orientation.toRotationMatrix().transpose()), half_(0.5 * size), margin_(margin) {}

  double gap(const Vec3& p) const {
    const Vec3 excess = (toLocal_ * p).cwiseAbs() - half_;
    const double outside = excess.maxCoeff();
    return -(outside <= 0.0 ? outside : excess.cwiseMax(0.0).norm()) - margin_;
  }
  double gap(const Vec3& p, Vec3& normal) const {
    const Vec3 local = toLocal_ * p;
    const Vec3 excess = local.cwiseAbs() - half_;
    int face = 0;
    Vec3 inward = Vec3::Zero();
    if (excess.maxCoeff(&face) > 0.0) {
      inward = excess.cwiseMax(0.0).normalized();
    } else {
      inward[face] = 1.0;
    }
    for (int k = 0; k < 3; ++k) inward[k] = -std::copysign(inward[k], local[k]);
    normal = toLocal_.transpose() * inward;
    return gap(p);
  }
  double leastGap(const Vec3& centre, const Vec3& half) const {
    const Vec3 excess = (toLocal_ * centre).cwiseAbs() + toLocal_.cwiseAbs() * half - half_;
    const double outside = excess.maxCoeff();
    return -(outside <= 0.0 ? outside : excess.cwiseMax(0.0).norm()) - margin_;
  }
  bool beyond(const Vec3& p, double distance) const { return gap(p) > distance; }

  /// The wall that the end lies farthest behind. The room inside is convex, so whatever the other
  /// walls and friction do later, a wall that has been dealt with is not entered again.
  bool touch(const Vec3& start, const Vec3& end, double rise, Touch& touch) const {
    const Vec3 to = toLocal_ * end;
    const Vec3 room = (half_.array() - margin_).max(0.0);
    if ((to.cwiseAbs() - room).maxCoeff() <= 0.0) return false;
    const Vec3 from = toLocal_ * start;
    const Vec3 limit = room.cwiseMax(from.cwiseAbs() - Vec3::Constant(rise));
    int wall = 0;
    const double push = (to.cwiseAbs() - limit).maxCoeff(&wall);
    if (!(push > 0.0)) return false;
    touch.normal = toLocal_.row(wall).transpose() * std::copysign(1.0, -to[wall]);
    touch.push = push;
    return true;
  }

 private:
  Eigen::Matrix3d toLocal_;
  Vec3 half_;
  double margin_;
};

inline Plane make(const PlaneShape&, const Quat& orientation, double margin) {
  return {orientation * Vec3::UnitZ(), margin};
}
inline Sphere make(const SphereShape& shape, const Quat&, double margin) {
  return {shape.radius, margin};
}
inline Box make(const BoxShape& shape, const Quat& orientation, double margin) {
  return {shape.size, orientation, margin};
}
inline Bounds make(const BoundsShape& shape, const Quat& orientation, double margin) {
  return {shape.size, orientation, margin};
}

/// Calls `function` with the geometry of the collider: the choice by shape is made here, once,
/// and not in the function's loop over particles.
template <class Function>
decltype(auto) visit(const Collider& collider, Function&& function) {
  return std::visit(
      [&](const auto& shape) {
        return function(make(shape, collider.obstacle().pose.orientation, collider.margin()));
      },
      collider.obstacle().shape);
}

}  // namespace cloth_sim::geometry
