#pragma once
/// \file From a sequence of poses to a pose that moves. No node, no master.

#include <optional>

#include "cloth_sim/clamp/moving_pose.h"

namespace cloth_sim {

/// Poses farther apart in time than this are single commands, and say nothing of a velocity [s].
constexpr double kLongestPeriod = 0.1;
/// A target goes on for this many periods of its source without a new pose.
constexpr double kHorizonPeriods = 2.0;

/// Gives each new pose the velocity of the way from the one before. So a target that is sampled
/// moves evenly.
class PoseTracker {
 public:
  /// \param stamp  of the pose [s]; 0: it holds for all time.
  /// \return the new target; nothing if the pose is the one that was there already. A stamp that is
  ///         older than the last one begins a new sequence.
  std::optional<MovingPose> add(double stamp, const Pose& pose);

  /// The last pose, standing still, if there is one: where a target belongs whose source is gone.
  std::optional<MovingPose> rest() const;

 private:
  struct Sample {
    double stamp = 0.0;  ///< [s]
    Pose pose;
  };
  std::optional<Sample> last_;
};

}  // namespace cloth_sim
