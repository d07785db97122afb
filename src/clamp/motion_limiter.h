#pragma once
/// \file Motion towards a target within limits on speed and acceleration, in discrete time.

#include "cloth_sim/types.h"

namespace cloth_sim {

/// Distance from the target below which it counts as reached [m] or [rad].
constexpr double kArrived = 1e-12;

/// Limits of a motion, in m/s and m/s^2 or in rad/s and rad/s^2.
struct MotionLimits {
  double speed = 0.0;         ///< > 0
  double acceleration = 0.0;  ///< > 0
};

/// Returns the greatest speed at which a body may cover the next step of `dt` [s] and still come to
/// rest after exactly `distance`, if it brakes by at most `acceleration` dt in every later step.
double brakingSpeed(double distance, double acceleration, double dt);

/// Returns the velocity for the next step of `dt` [s]: towards the target as fast as the limits and
/// braking in time allow, and within `limits.acceleration` dt of `velocity`. If the position then
/// moves by this velocity times dt in every step, it arrives from rest on a straight line without
/// overshoot, and from any velocity within the limits.
/// \param toTarget  vector from the position to the target.
Vec3 limitedVelocity(const Vec3& toTarget, const Vec3& velocity, const MotionLimits& limits,
                     double dt);

}  // namespace cloth_sim
