#pragma once
/// \file An obstacle as a scene or a command describes it.

#include <optional>
#include <string>

#include "cloth_sim/contact/shape.h"

namespace cloth_sim {

/// A solid that cloth can touch. It moves at constant velocity and does not rotate by itself.
struct Obstacle {
  std::string name;
  Shape shape;
  Pose pose;
  Vec3 velocity = Vec3::Zero();  ///< of the origin of the pose [m/s]
  /// Coulomb coefficient [-], >= 0; absent: that of the fabric of each cloth.
  std::optional<double> friction;
  /// Rate at which touching particles lose their tangential speed relative to the obstacle, in
  /// addition to friction [1/s], >= 0.
  double tangentialDecay = 0.0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, shape, pose, velocity, friction, tangentialDecay);
  }
};

}  // namespace cloth_sim
