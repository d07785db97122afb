#pragma once
/// \file A solid box as an obstacle: a table top, a board.

#include <cmath>

#include "cloth_sim/contact/shape_geometry.h"

namespace cloth_sim {
namespace geometry {

/// A solid box around the origin.
template <class Axes>
class Box {
 public:
  static constexpr int kMaxHits = 1;

  /// \param size  edge lengths [m].
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
    if (distance > 0.0) {  // the nearest feature is the face, edge or corner below the point
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

  /// Tests the axes of this box as separating axes; the bound is loose for a rotated box.
  double leastGap(const Vec3& centre, const Vec3& half) const {
    const Vec3 excess = axes_.toLocal(centre).cwiseAbs() - axes_.extent(half) - half_;
    return excess.maxCoeff() - margin_;
  }
  bool isBeyond(const Vec3& p, double distance) const {
    return excessOf(axes_.toLocal(p)).maxCoeff() > margin_ + distance;
  }

  [[gnu::always_inline]] bool sweep(const Vec3& start, const Vec3& end, double rise,
                                    SweepHit& hit) const {
    const Vec3 to = axes_.toLocal(end);
    const Vec3 from = axes_.toLocal(start);
    if (misses<2>(from, to)) return false;  // z first: most boxes are table tops
    // Most paths stay over one face, where the box is a plane.
    const Vec3 excessFrom = excessOf(from);
    const Vec3 excessTo = excessOf(to);
    if (staysOver<2>(excessFrom, excessTo)) return sweepFace<2>(from, to, rise, hit);
    if (misses<0>(from, to) || misses<1>(from, to)) return false;
    if (staysOver<1>(excessFrom, excessTo)) return sweepFace<1>(from, to, rise, hit);
    if (staysOver<0>(excessFrom, excessTo)) return sweepFace<0>(from, to, rise, hit);
    return sweepConvex(*this, start, end, rise, hit);
  }

  std::optional<LevelTop> levelTop() const {
    if (!Axes::kUpright) return std::nullopt;
    return LevelTop{half_.x(), half_.y(), half_.z(), half_.z() + margin_};
  }

 private:
  /// Distance of a local point beyond each pair of faces [m], negative between them.
  Vec3 excessOf(const Vec3& local) const { return local.cwiseAbs() - half_; }

  /// Tells whether both ends of the path lie beyond the same one of the two faces across the axis.
  template <int kAxis>
  bool misses(const Vec3& from, const Vec3& to) const {
    const double limit = half_[kAxis] + margin_;
    return (from[kAxis] >= limit && to[kAxis] >= limit) ||
           (from[kAxis] <= -limit && to[kAxis] <= -limit);
  }

  /// Tells whether the nearest feature to the start is a face across the axis, and the path stays
  /// over it. Takes `excessOf` of both ends.
  template <int kAxis>
  static bool staysOver(const Vec3& from, const Vec3& to) {
    const int a = (kAxis + 1) % 3;
    const int b = (kAxis + 2) % 3;
    const double most = std::min(0.0, from[kAxis]);
    return from[a] <= most && from[b] <= most && to[a] <= 0.0 && to[b] <= 0.0;
  }

  /// `sweep` of a path over a face across the axis, in local coordinates.
  template <int kAxis>
  bool sweepFace(const Vec3& from, const Vec3& to, double rise, SweepHit& hit) const {
    const double side = std::copysign(1.0, from[kAxis]);
    const double level = half_[kAxis] + margin_;
    const double after = side * to[kAxis] - level;
    if (after >= 0.0) return false;
    hit.normal = axes_.toWorld(side * Vec3::Unit(kAxis));
    hit.push = std::min(0.0, side * from[kAxis] - level + rise) - after;
    return hit.push > 0.0;
  }

  Axes axes_;
  Vec3 half_;  ///< half edge lengths [m]
  double margin_;
};

}  // namespace geometry

/// A solid box around the obstacle's position.
struct BoxShape {
  Vec3 size = Vec3::Ones();  ///< edge lengths [m], > 0
  /// Whether faces and edges of the cloth meet its corners and edges; otherwise only particles do.
  bool sharpEdges = false;

  static constexpr std::array<const char*, 2> kTypes{"board", "box"};
  static constexpr auto keys() {
    return std::make_tuple(ShapeKey("size", &BoxShape::size),
                           ShapeKey("sharp_edges", &BoxShape::sharpEdges));
  }

  template <class Function>
  decltype(auto) visitGeometry(const Quat& orientation, double margin, Function&& function) const {
    return geometry::visitAxes<geometry::Box>(size, orientation, margin, function);
  }

  std::vector<DrawnPart> drawing() const {
    constexpr Rgba kColour{1.0f, 0.93f, 0.84f};  // bright, because rviz lights level faces weakly
    return {{DrawnPart::Kind::kBox, size, Vec3::Zero(), kColour}};
  }
  std::optional<double> handleRadius() const { return 0.5 * size.minCoeff(); }
  std::shared_ptr<const TriangleSurface> sharpSurface() const;
};

}  // namespace cloth_sim
