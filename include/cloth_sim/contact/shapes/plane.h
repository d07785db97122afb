#pragma once
/// \file An infinite plane as an obstacle.

#include <limits>

#include "cloth_sim/contact/shape_geometry.h"

namespace cloth_sim {
namespace geometry {

/// The half space below a plane through the origin.
class Plane {
 public:
  static constexpr int kMaxHits = 1;

  Plane(const Vec3& normal, double margin) : normal_(normal), margin_(margin) {}

  double gap(const Vec3& p) const { return normal_.dot(p) - margin_; }
  double gap(const Vec3& p, Vec3& normal) const {
    normal = normal_;
    return gap(p);
  }
  double leastGap(const Vec3& centre, const Vec3& half) const {
    return gap(centre) - normal_.cwiseAbs().dot(half);
  }
  bool isBeyond(const Vec3& p, double distance) const { return gap(p) > distance; }

  [[gnu::always_inline]] bool sweep(const Vec3& start, const Vec3& end, double rise,
                                    SweepHit& hit) const {
    const double after = gap(end);
    if (after >= 0.0) return false;
    hit.normal = normal_;
    hit.push = std::min(0.0, gap(start) + rise) - after;
    return hit.push > 0.0;
  }

  std::optional<LevelTop> levelTop() const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (normal_ != Vec3::UnitZ()) return std::nullopt;
    return LevelTop{kInfinity, kInfinity, -kInfinity, margin_};
  }

 private:
  Vec3 normal_;
  double margin_;
};

}  // namespace geometry

/// The half space below a plane through the obstacle's position; its z axis is the outward normal.
struct PlaneShape {
  static constexpr std::array<const char*, 1> kTypes{"plane"};
  static constexpr auto keys() { return std::make_tuple(); }

  template <class Function>
  decltype(auto) visitGeometry(const Quat& orientation, double margin, Function&& function) const {
    return function(geometry::Plane(orientation * Vec3::UnitZ(), margin));
  }

  /// A square sheet stands for the infinite plane.
  std::vector<DrawnPart> drawing() const {
    constexpr double kSide = 4.0;        // [m]
    constexpr double kThickness = 0.01;  // [m]
    return {{DrawnPart::Kind::kBox,
             {kSide, kSide, kThickness},
             {0.0, 0.0, -0.5 * kThickness},
             {0.95f, 0.96f, 0.97f}}};
  }
  std::optional<double> handleRadius() const { return std::nullopt; }
  std::shared_ptr<const TriangleSurface> sharpSurface() const { return nullptr; }
};

}  // namespace cloth_sim
