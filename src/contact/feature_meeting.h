#pragma once
/// \file A sharp corner or edge of a mesh, and the face or edge of the cloth that it meets.

#include <algorithm>
#include <array>
#include <limits>

#include "sharp_features.h"

namespace cloth_sim {

/// A mesh with its sharp corners and edges, in space.
struct PlacedFeatures {
  const TriangleSurface& surface;
  const SharpFeatures& features;
  Vec3 position;             ///< of its origin [m]
  Eigen::Matrix3d rotation;  ///< from its axes to those of the world
};

/// Corners of a face of the cloth, or in the first two places the ends of an edge [m].
using MeetingPoints = std::array<Vec3, 3>;
/// Weights of such points; their sum is 1.
using MeetingWeights = std::array<double, 3>;

/// Weight by which a point may be beside a face or an edge [-].
constexpr double kBesideFeature = 1e-9;

/// A corner of the mesh and a face of the cloth.
struct CornerAtFace {
  static constexpr int kPoints = 3;
  Vec3 point;  ///< [m]

  /// Finds the unit normal of a face. \return false if it has no area.
  static bool normal(const MeetingPoints& x, Vec3& out) {
    out = (x[1] - x[0]).cross(x[2] - x[0]);
    const double size = out.norm();
    out /= size;
    return size > 0.0;
  }
  /// Six times the volume between the face and the corner [m^3]; its sign is the side.
  double volume(const MeetingPoints& x) const {
    return (x[1] - x[0]).cross(x[2] - x[0]).dot(point - x[0]);
  }
  /// Finds the weights of the foot of the corner. \return whether it is in the face.
  bool weigh(const MeetingPoints& x, const Vec3& normal, MeetingWeights& weight) const {
    const Vec3 foot = point - x[0];
    const Vec3 a = x[1] - x[0];
    const Vec3 b = x[2] - x[0];
    const double area = normal.dot(a.cross(b));
    weight[1] = normal.dot(foot.cross(b)) / area;
    weight[2] = normal.dot(a.cross(foot)) / area;
    weight[0] = 1.0 - weight[1] - weight[2];
    return *std::min_element(weight.begin(), weight.end()) >= -kBesideFeature;
  }
};

/// An edge of the mesh and an edge of the cloth.
struct EdgeAtEdge {
  static constexpr double kLeastSine = 1e-3;  ///< of the angle of two edges that cross
  static constexpr int kPoints = 2;
  Vec3 point;  ///< one end [m]
  Vec3 along;  ///< from there to the other end [m]

  /// Finds the unit vector normal to both. \return false if they are parallel.
  bool normal(const MeetingPoints& x, Vec3& out) const {
    const Vec3 edge = x[1] - x[0];
    out = along.cross(edge);
    const double size = out.norm();
    out /= size;
    return size > kLeastSine * along.norm() * edge.norm();
  }
  /// Six times the volume between both edges [m^3]; its sign is the side.
  double volume(const MeetingPoints& x) const { return along.cross(x[1] - x[0]).dot(point - x[0]); }
  /// Finds the weights of the point of the cloth that is closest to the line of the edge.
  /// \return whether the closest points of both lines are on the edges.
  bool weigh(const MeetingPoints& x, const Vec3& normal, MeetingWeights& weight) const {
    const Vec3 edge = x[1] - x[0];
    const double size = normal.dot(along.cross(edge));
    const Vec3 apart = x[0] - point;
    const double onMesh = normal.dot(apart.cross(edge)) / size;
    weight[1] = normal.dot(apart.cross(along)) / size;
    weight[0] = 1.0 - weight[1];
    weight[2] = 0.0;
    const auto isOn = [](double part) {
      return part >= -kBesideFeature && part <= 1.0 + kBesideFeature;
    };
    return isOn(onMesh) && isOn(weight[1]);
  }
};

/// Calls `function` with the feature in space.
template <class Function>
decltype(auto) visitFeature(const PlacedFeatures& placed, std::int32_t feature,
                            Function&& function) {
  const SharpFeature& it = placed.features[feature];
  const Vec3 point = placed.position + placed.rotation * it.ends[0];
  if (it.isCorner) return function(CornerAtFace{point});
  return function(EdgeAtEdge{point, placed.rotation * (it.ends[1] - it.ends[0])});
}

/// A box that grows around points.
struct PointBox {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;

  void add(const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

}  // namespace cloth_sim
