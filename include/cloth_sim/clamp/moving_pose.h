#pragma once
/// \file A pose that goes on moving for a while: bridges the time between two samples of a source.

#include <string>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// A pose with a velocity that holds for `horizon`; then the pose stands still. So a clamp or an
/// obstacle that tracks a source stops when the source stops sending.
struct MovingPose {
  Pose pose;
  Vec3 linear = Vec3::Zero();   ///< velocity of the pose's origin [m/s]
  Vec3 angular = Vec3::Zero();  ///< in the world's axes [rad/s]
  double horizon = 0.0;         ///< how long it goes on moving [s], >= 0

  /// Moves on by `dt` [s], and shortens the horizon by as much.
  void advance(double dt);

  /// Tells whether it moves no longer.
  bool isStill() const { return horizon <= 0.0 || (linear.isZero(0.0) && angular.isZero(0.0)); }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(pose, linear, angular, horizon);
  }
};

/// Returns why a moving pose cannot be a target, in one sentence; empty if it can.
std::string validationError(const MovingPose& target);

/// Returns the same target with an orientation of norm 1.
MovingPose normalized(MovingPose target);

}  // namespace cloth_sim
