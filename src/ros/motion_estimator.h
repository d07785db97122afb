#pragma once
/// \file Velocities from a sequence of poses. Needs no node and no master.

#include <optional>

#include "cloth_sim/clamp/moving_pose.h"

namespace cloth_sim {

/// Poses farther apart in time than this are single commands; no velocity is derived from them [s].
constexpr double kLongestPeriod = 0.1;
/// Number of periods of its source for which a target keeps moving without a new pose.
constexpr double kHorizonPeriods = 2.0;

/// Estimates velocities by the difference of successive poses, so that a target sampled at a low
/// rate moves evenly between the samples.
class MotionEstimator {
 public:
  /// Adds a pose of the sequence. A stamp older than the last one begins a new sequence.
  /// \param stamp  of the pose [s]; 0: it holds for all time.
  /// \return the new target; nothing if the pose is not new.
  std::optional<MovingPose> add(double stamp, const Pose& pose);

  /// The last pose at velocity zero, the target once the source is lost; nothing before the first
  /// pose.
  std::optional<MovingPose> rest() const;

 private:
  struct Sample {
    double stamp = 0.0;  ///< [s]
    Pose pose;
  };
  std::optional<Sample> last_;
};

}  // namespace cloth_sim
