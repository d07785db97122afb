#include "motion_estimator.h"

#include <cmath>

namespace cloth_sim {
namespace {

bool isSame(const Pose& p, const Pose& q) {
  return p.position == q.position && p.orientation.coeffs() == q.orientation.coeffs();
}

/// Rotation vector of the shortest turn from one orientation to another, in the world's axes [rad].
Vec3 turnBetween(const Quat& from, const Quat& to) {
  const Eigen::AngleAxisd turn(to * from.conjugate());
  const double angle = turn.angle() > M_PI ? turn.angle() - 2.0 * M_PI : turn.angle();
  return angle * turn.axis();
}

}  // namespace

std::optional<MovingPose> MotionEstimator::add(double stamp, const Pose& pose) {
  const std::optional<Sample> before = last_;
  if (before && stamp == before->stamp && (stamp != 0.0 || isSame(pose, before->pose))) {
    return std::nullopt;
  }
  last_ = {stamp, pose};
  MovingPose target;
  target.pose = pose;
  const double period = before ? stamp - before->stamp : 0.0;
  if (!(period > 0.0) || period > kLongestPeriod) return target;
  target.linear = (pose.position - before->pose.position) / period;
  target.angular = turnBetween(before->pose.orientation, pose.orientation) / period;
  target.horizon = kHorizonPeriods * period;
  return target;
}

std::optional<MovingPose> MotionEstimator::rest() const {
  if (!last_) return std::nullopt;
  MovingPose target;
  target.pose = last_->pose;
  return target;
}

}  // namespace cloth_sim
