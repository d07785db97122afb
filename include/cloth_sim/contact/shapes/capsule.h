#pragma once
/// \file A rod with round ends as an obstacle: a finger, a hanger.

#include "cloth_sim/contact/shape_geometry.h"

namespace cloth_sim {
namespace geometry {

/// All points nearer than a radius to a segment around the origin.
class Capsule {
 public:
  static constexpr int kMaxHits = 1;

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
  /// The gap changes by no more than the point moves.
  double leastGap(const Vec3& centre, const Vec3& half) const { return gap(centre) - half.norm(); }
  bool isBeyond(const Vec3& p, double distance) const {
    const double limit = reach_ + distance;
    return limit < 0.0 || fromSegment(p).squaredNorm() > limit * limit;
  }

  [[gnu::always_inline]] bool sweep(const Vec3& start, const Vec3& end, double rise,
                                    SweepHit& hit) const {
    return sweepNearConvex(*this, start, end, rise, hit);
  }

  std::optional<LevelTop> levelTop() const { return std::nullopt; }

 private:
  /// Distance from the axis below which round-off decides the direction away from it [m].
  static constexpr double kOnAxis = 1e-12;

  /// Vector to `p` from the nearest point of the segment [m].
  Vec3 fromSegment(const Vec3& p) const {
    return p - std::clamp(axis_.dot(p), -half_, half_) * axis_;
  }

  Vec3 axis_;
  double half_;   ///< half the length of the segment [m]
  double reach_;  ///< radius plus margin [m]
};

}  // namespace geometry

/// All points nearer than the radius to a segment of the z axis around the obstacle's position.
struct CapsuleShape {
  double radius = 0.05;  ///< [m], > 0
  double length = 0.2;   ///< of the segment, between the centres of the round ends [m], > 0

  static constexpr std::array<const char*, 1> kTypes{"capsule"};
  static constexpr auto keys() {
    return std::make_tuple(ShapeKey("radius", &CapsuleShape::radius),
                           ShapeKey("length", &CapsuleShape::length));
  }

  template <class Function>
  decltype(auto) visitGeometry(const Quat& orientation, double margin, Function&& function) const {
    return function(geometry::Capsule(orientation * Vec3::UnitZ(), length, radius, margin));
  }

  /// A cylinder with a ball at each end.
  std::vector<DrawnPart> drawing() const {
    const double width = 2.0 * radius;
    const Vec3 end(0.0, 0.0, 0.5 * length);
    return {{DrawnPart::Kind::kCylinder, {width, width, length}, Vec3::Zero(), kRoundColour},
            {DrawnPart::Kind::kSphere, Vec3::Constant(width), -end, kRoundColour},
            {DrawnPart::Kind::kSphere, Vec3::Constant(width), end, kRoundColour}};
  }
  std::optional<double> handleRadius() const { return radius; }
  std::shared_ptr<const TriangleSurface> sharpSurface() const { return nullptr; }
};

}  // namespace cloth_sim
