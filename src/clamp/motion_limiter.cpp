#include "motion_limiter.h"

#include <algorithm>
#include <cmath>

namespace cloth_sim {
// In units of v0 = acceleration dt, braking from the speed r = k + f (k whole, 0 <= f < 1) covers
// (k + f) + (k - 1 + f) + ... + f = k (k + 1) / 2 + (k + 1) f steps of v0 dt. This is increasing
// and piecewise linear in r; we invert it. Each step then leaves exactly the distance of r - 1, and
// the last one (k = 0) ends at the target, at a speed from which the body can stop.
double brakingSpeed(double distance, double acceleration, double dt) {
  const double unit = acceleration * dt;
  const double steps = distance / (unit * dt);
  const double whole = std::floor(0.5 * (std::sqrt(1.0 + 8.0 * steps) - 1.0));
  const double rest = steps - 0.5 * whole * (whole + 1.0);
  return unit * (whole + rest / (whole + 1.0));
}

Vec3 limitedVelocity(const Vec3& toTarget, const Vec3& velocity, const MotionLimits& limits,
                     double dt) {
  const double distance = toTarget.norm();
  Vec3 desired = Vec3::Zero();
  if (distance > kArrived) {
    const double braking = brakingSpeed(distance, limits.acceleration, dt);
    desired = toTarget * (std::min(limits.speed, braking) / distance);
  }
  const Vec3 change = desired - velocity;
  const double size = change.norm();
  const double allowed = limits.acceleration * dt;
  return size <= allowed ? desired : Vec3(velocity + change * (allowed / size));
}

}  // namespace cloth_sim
