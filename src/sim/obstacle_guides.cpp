#include "cloth_sim/sim/obstacle_guides.h"

#include <algorithm>

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

void ObstacleGuides::set(const std::string& obstacle, const MovingPose& target) {
  drop(obstacle);
  guides_.push_back({obstacle, target});
}

void ObstacleGuides::drop(const std::string& obstacle) {
  const auto named = [&](const Guide& guide) { return guide.obstacle == obstacle; };
  guides_.erase(std::remove_if(guides_.begin(), guides_.end(), named), guides_.end());
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
    if (velocity.norm() > kFastestObstacle) {
      collider->place(goal, Vec3::Zero(), time);
    } else {
      collider->place(from, velocity, time, turnSpeed(from.orientation, goal.orientation, dt));
    }
  }
}

}  // namespace cloth_sim
