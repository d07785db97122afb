#include "cloth_sim/sim/obstacle_guides.h"

#include <algorithm>
#include <utility>

#include "support/rotation.h"

namespace cloth_sim {
namespace {

/// An obstacle nearer to its target than this has reached it, but for round-off [m] or [-].
constexpr double kRoundOff = 1e-12;

bool isNear(const Pose& a, const Pose& b) {
  return (a.position - b.position).norm() <= kRoundOff &&
         (a.orientation.coeffs() - b.orientation.coeffs()).norm() <= kRoundOff;
}

/// The angular velocity that turns one orientation into another within `dt` [s], in the axes of the
/// world [rad/s].
Vec3 turnSpeed(const Quat& from, const Quat& to, double dt) {
  if (from.coeffs() == to.coeffs()) return Vec3::Zero();
  return rotationVector(to * from.conjugate()) / dt;
}

}  // namespace

std::vector<ObstacleGuides::Guide>::iterator ObstacleGuides::find(const std::string& obstacle) {
  return std::find_if(guides_.begin(), guides_.end(),
                      [&](const Guide& guide) { return guide.obstacle == obstacle; });
}

void ObstacleGuides::set(const std::string& obstacle, const MovingPose& target) {
  const auto guide = find(obstacle);
  if (guide == guides_.end()) {
    guides_.push_back({obstacle, target});
  } else {
    guide->target = target;
  }
}

void ObstacleGuides::drop(const std::string& obstacle) {
  const auto guide = find(obstacle);
  if (guide != guides_.end()) guides_.erase(guide);
}

bool ObstacleGuides::areIdle(double time, const ColliderSet& colliders) const {
  return std::all_of(guides_.begin(), guides_.end(), [&](const Guide& guide) {
    const Collider* collider = colliders.find(guide.obstacle);
    return collider == nullptr ||
           (guide.target.isStill() && isNear(collider->poseAt(time), guide.target.pose));
  });
}

void ObstacleGuides::steer(double time, double dt, ColliderSet& colliders) {
  for (Guide& guide : guides_) {
    Collider* collider = colliders.find(guide.obstacle);
    if (collider == nullptr) continue;
    guide.target.advance(dt);
    const Pose& goal = guide.target.pose;
    const Pose from = collider->poseAt(time);
    const Vec3 velocity = (goal.position - from.position) / dt;
    const bool isPlaced =
        !std::exchange(guide.hasBegun, true) || velocity.norm() > kFastestObstacle;
    if (isPlaced) {
      collider->place(goal, Vec3::Zero(), time);
    } else {
      collider->place(from, velocity, time, turnSpeed(from.orientation, goal.orientation, dt));
    }
  }
}

}  // namespace cloth_sim
