#pragma once
/// \file A ball as an obstacle.

#include "cloth_sim/contact/shape_geometry.h"

namespace cloth_sim {
namespace geometry {

/// A ball around the origin.
class Sphere {
 public:
  static constexpr int kMaxHits = 1;

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
  bool isBeyond(const Vec3& p, double distance) const {
    const double limit = reach_ + distance;
    return limit < 0.0 || p.squaredNorm() > limit * limit;
  }

  [[gnu::always_inline]] bool sweep(const Vec3& start, const Vec3& end, double rise,
                                    SweepHit& hit) const {
    return !misses(start, end) && sweepConvex(*this, start, end, rise, hit);
  }

  std::optional<LevelTop> levelTop() const { return std::nullopt; }

 private:
  /// Tells whether the path ends outside and never comes nearer than the radius; exact, without a
  /// root.
  bool misses(const Vec3& start, const Vec3& end) const {
    const double radius2 = reach_ * reach_;
    if (end.squaredNorm() < radius2) return false;
    const Vec3 path = end - start;
    const double length2 = path.squaredNorm();
    const double along = -start.dot(path);  // path parameter of the nearest point, times length2
    if (along <= 0.0 || along >= length2) return true;
    return start.squaredNorm() * length2 - along * along >= radius2 * length2;
  }

  double reach_;  ///< radius plus margin [m]
};

}  // namespace geometry

/// A solid ball around the obstacle's position.
struct SphereShape {
  double radius = 0.1;  ///< [m], > 0

  static constexpr std::array<const char*, 1> kTypes{"sphere"};
  static constexpr auto keys() { return std::make_tuple(ShapeKey("radius", &SphereShape::radius)); }

  template <class Function>
  decltype(auto) visitGeometry(const Quat& /*orientation*/, double margin,
                               Function&& function) const {
    return function(geometry::Sphere(radius, margin));
  }

  std::vector<DrawnPart> drawing() const {
    return {{DrawnPart::Kind::kSphere, Vec3::Constant(2.0 * radius), Vec3::Zero(), kRoundColour}};
  }
  std::optional<double> handleRadius() const { return radius; }
  std::shared_ptr<const TriangleSurface> sharpSurface() const { return nullptr; }
};

}  // namespace cloth_sim
