#include "cloth_sim/clamp/moving_pose.h"

#include <algorithm>
#include <cmath>

#include "cloth_sim/validation.h"
#include "support/rotation.h"

namespace cloth_sim {

void MovingPose::advance(double dt) {
  const double moving = std::min(dt, horizon);
  if (moving <= 0.0) return;
  pose.position += linear * moving;
  pose.orientation = turned(pose.orientation, angular, moving);
  horizon -= moving;
}

std::string validationError(const MovingPose& target) {
  if (!target.linear.allFinite()) return "velocity: expected three finite numbers";
  if (!target.angular.allFinite()) return "angular velocity: expected three finite numbers";
  if (!isNotNegative(target.horizon)) return "horizon: expected a number >= 0";
  return validationError(target.pose);
}

MovingPose normalized(MovingPose target) {
  target.pose.orientation.normalize();
  return target;
}

}  // namespace cloth_sim
