#pragma once
/// \file A pose that goes on moving for a while: what a source of poses says between two of them.

#include "cloth_sim/types.h"

namespace cloth_sim {

/// A pose with its velocity, which holds for `horizon`; then it stands still. So whoever stops
/// sending poses stops what follows them.
struct MovingPose {
  Pose pose;
  Vec3 linear = Vec3::Zero();   ///< velocity of the pose's origin [m/s]
  Vec3 angular = Vec3::Zero();  ///< in the world's axes [rad/s]
  double horizon = 0.0;         ///< how long it goes on [s], >= 0

  /// Goes on by `dt` [s], and leaves that much less of the horizon.
  void advance(double dt);

  /// Whether it moves no more.
  bool isStill() const { return horizon <= 0.0 || (linear.isZero(0.0) && angular.isZero(0.0)); }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(pose, linear, angular, horizon);
  }
};

}  // namespace cloth_sim
