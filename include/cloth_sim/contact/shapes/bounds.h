#pragma once
/// \file The outside of a box as an obstacle: particles stay within.

#include <cmath>

#include "cloth_sim/contact/shape_geometry.h"

namespace cloth_sim {
namespace geometry {

/// The outside of a box around the origin.
template <class Axes>
class Bounds {
 public:
  static constexpr int kMaxHits = 3;  ///< a corner has three walls

  /// \param size  edge lengths of the box [m].
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
  bool isBeyond(const Vec3& p, double distance) const { return gap(p) > distance; }

  /// Stops the particle at the wall behind which its end lies deepest. The room inside is convex,
  /// so later walls and friction never push the particle back into a wall that it has left.
  [[gnu::always_inline]] bool sweep(const Vec3& start, const Vec3& end, double rise,
                                    SweepHit& hit) const {
    const Vec3 to = axes_.toLocal(end);
    if ((to.cwiseAbs() - room_).maxCoeff() <= 0.0) return false;
    const Vec3 from = axes_.toLocal(start);
    const Vec3 limit = room_.cwiseMax(from.cwiseAbs() - Vec3::Constant(rise));
    int wall = 0;
    const double push = (to.cwiseAbs() - limit).maxCoeff(&wall);
    if (!(push > 0.0)) return false;
    hit.normal = axes_.toWorld(std::copysign(1.0, -to[wall]) * Vec3::Unit(wall));
    hit.push = push;
    return true;
  }

  std::optional<LevelTop> levelTop() const { return std::nullopt; }

 private:
  Axes axes_;
  Vec3 half_;  ///< half edge lengths of the box [m]
  double margin_;
  Vec3 room_;  ///< half edge lengths of the box that particles may be in [m]
};

}  // namespace geometry

/// The outside of a box around the obstacle's position. The box should be much larger than the
/// margin.
struct BoundsShape {
  Vec3 size = Vec3::Ones();  ///< edge lengths [m], > 0

  static constexpr std::array<const char*, 1> kTypes{"bounds"};
  static constexpr auto keys() { return std::make_tuple(ShapeKey("size", &BoundsShape::size)); }

  template <class Function>
  decltype(auto) visitGeometry(const Quat& orientation, double margin, Function&& function) const {
    return geometry::visitAxes<geometry::Bounds>(size, orientation, margin, function);
  }

  std::vector<DrawnPart> drawing() const {
    return {{DrawnPart::Kind::kBoxEdges, size, Vec3::Zero(), {0.35f, 0.40f, 0.50f, 0.6f}}};
  }
  std::optional<double> handleRadius() const { return std::nullopt; }
  std::shared_ptr<const TriangleSurface> sharpSurface() const { return nullptr; }
};

}  // namespace cloth_sim
