#pragma once
/// \file An obstacle as a scene or a command describes it.

#include <optional>
#include <string>

#include "cloth_sim/contact/shape.h"

namespace cloth_sim {

/// A solid, or a sheet, that cloth can touch. It moves and turns at constant velocities.
struct Obstacle {
  std::string name;
  Shape shape;
  Pose pose;
  Vec3 velocity = Vec3::Zero();  ///< of the origin of the pose [m/s]
  /// About the origin of the pose, in the axes of the world [rad/s].
  Vec3 angularVelocity = Vec3::Zero();
  /// Coulomb coefficient [-], >= 0; absent: that of the fabric of each cloth.
  std::optional<double> friction;
  /// Rate at which touching particles lose their tangential speed relative to the obstacle, in
  /// addition to friction [1/s], >= 0.
  double tangentialDecay = 0.0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, shape, pose, velocity, angularVelocity, friction, tangentialDecay);
  }
};

}  // namespace cloth_sim
