#pragma once
/// \file Vector types and ids that every folder uses. All quantities are SI, all world
/// coordinates are right-handed with z up (REP 103).

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace cereal {
class access;  // reads and writes private members; see sim/archive.h
}

namespace cloth_sim {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Quat = Eigen::Quaterniond;

using VertexId = std::int32_t;
using FaceId = std::int32_t;

constexpr std::int32_t kNone = -1;

/// Rigid pose: a point p of the body is at `position + orientation * p` in the world.
struct Pose {
  Vec3 position = Vec3::Zero();         ///< [m]
  Quat orientation = Quat::Identity();  ///< unit quaternion

  Vec3 toWorld(const Vec3& local) const { return position + orientation * local; }
  Vec3 toLocal(const Vec3& world) const { return orientation.conjugate() * (world - position); }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(position, orientation);
  }
};

}  // namespace cloth_sim
