#include "motion_estimator.h"

#include "support/rotation.h"

namespace cloth_sim {
namespace {

bool isSame(const Pose& p, const Pose& q) {
  return p.position == q.position && p.orientation.coeffs() == q.orientation.coeffs();
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
  target.angular = rotationVector(pose.orientation * before->pose.orientation.conjugate()) / period;
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
