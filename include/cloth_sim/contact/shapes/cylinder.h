#pragma once
/// \file A cylinder with flat ends as an obstacle: a roll, a pole, a round table.

#include <cmath>

#include "cloth_sim/contact/shape_geometry.h"

namespace cloth_sim {
namespace geometry {

/// All points nearer than a radius to an axis through the origin, between two planes across it.
class Cylinder {
 public:
  static constexpr int kMaxHits = 1;

  /// \param axis  unit vector.
  Cylinder(const Vec3& axis, double length, double radius, double margin)
      : axis_(axis), half_(0.5 * length), radius_(radius), margin_(margin) {}

  double gap(const Vec3& p) const {
    const Excess excess = excessOf(p);
    return excess.distance() - margin_;
  }
  double gap(const Vec3& p, Vec3& normal) const {
    const Excess excess = excessOf(p);
    const double distance = excess.distance();
    const Vec3 end = std::copysign(1.0, excess.along) * axis_;
    const Vec3 side =
        excess.from > kOnAxis ? Vec3(excess.out / excess.from) : axis_.unitOrthogonal();
    if (distance > 0.0) {  // the nearest feature is an end, the side or the edge between them
      normal = (std::max(excess.axial, 0.0) * end + std::max(excess.radial, 0.0) * side) / distance;
    } else {
      normal = excess.axial > excess.radial ? end : side;
    }
    return distance - margin_;
  }
  /// The gap changes by no more than the point moves.
  double leastGap(const Vec3& centre, const Vec3& half) const { return gap(centre) - half.norm(); }
  bool isBeyond(const Vec3& p, double distance) const { return gap(p) > distance; }

  [[gnu::always_inline]] bool sweep(const Vec3& start, const Vec3& end, double rise,
                                    SweepHit& hit) const {
    return sweepNearConvex(*this, start, end, rise, hit);
  }

  std::optional<LevelTop> levelTop() const { return std::nullopt; }

 private:
  /// Distance from the axis below which round-off decides the direction away from it [m].
  static constexpr double kOnAxis = 1e-12;

  /// A point beyond the planes of the ends and beyond the side.
  struct Excess {
    double along;   ///< the axis [m]
    Vec3 out;       ///< from the axis [m]
    double from;    ///< the axis [m]
    double axial;   ///< beyond the nearer end, negative between them [m]
    double radial;  ///< beyond the side, negative within [m]

    double distance() const {
      if (axial <= 0.0 || radial <= 0.0) return std::max(axial, radial);
      return std::hypot(axial, radial);
    }
  };
  Excess excessOf(const Vec3& p) const {
    const double along = axis_.dot(p);
    const Vec3 out = p - along * axis_;
    const double from = out.norm();
    return {along, out, from, std::abs(along) - half_, from - radius_};
  }

  Vec3 axis_;
  double half_;    ///< half the length [m]
  double radius_;  ///< [m]
  double margin_;
};

}  // namespace geometry

/// A solid cylinder along the z axis around the obstacle's position, with flat ends.
struct CylinderShape {
  double radius = 0.05;  ///< [m], > 0
  double length = 0.2;   ///< [m], > 0

  static constexpr std::array<const char*, 1> kTypes{"cylinder"};
  static constexpr auto keys() {
    return std::make_tuple(ShapeKey("radius", &CylinderShape::radius),
                           ShapeKey("length", &CylinderShape::length));
  }

  template <class Function>
  decltype(auto) visitGeometry(const Quat& orientation, double margin, Function&& function) const {
    return function(geometry::Cylinder(orientation * Vec3::UnitZ(), length, radius, margin));
  }

  std::vector<DrawnPart> drawing() const {
    const double width = 2.0 * radius;
    return {{DrawnPart::Kind::kCylinder, {width, width, length}, Vec3::Zero(), kRoundColour}};
  }
  std::optional<double> handleRadius() const { return std::min(radius, 0.5 * length); }
  std::shared_ptr<const TriangleSurface> sharpSurface() const { return nullptr; }
};

}  // namespace cloth_sim
