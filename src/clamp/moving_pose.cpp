#include "cloth_sim/clamp/moving_pose.h"

#include <algorithm>

#include "motion_limiter.h"

namespace cloth_sim {

void MovingPose::advance(double dt) {
  const double moving = std::min(dt, horizon);
  if (moving <= 0.0) return;
  pose.position += linear * moving;
  pose.orientation = turned(pose.orientation, angular, moving);
  horizon -= moving;
}

}  // namespace cloth_sim
