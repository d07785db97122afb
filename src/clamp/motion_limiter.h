#pragma once
/// \file Following a target within limits on speed and acceleration, in discrete time.

#include "cloth_sim/types.h"

namespace cloth_sim {

/// What is nearer to its target than this is there [m] or [rad].
constexpr double kArrived = 1e-12;

/// Of a motion: [m/s] and [m/s^2], or [rad/s] and [rad/s^2].
struct MotionLimits {
  double speed = 0.0;         ///< > 0
  double acceleration = 0.0;  ///< > 0
};

/// The greatest speed at which a body may cover the next step of length `dt` so that, slowing down
/// by `acceleration` dt at most in every step after it, it comes to rest after `distance` exactly.
double brakingSpeed(double distance, double acceleration, double dt);

/// The velocity for the next step of length `dt`: towards the target as fast as the limits and
/// braking in time allow, from `velocity` by a change of `limits.acceleration` dt at most. If the
/// position then moves by this velocity times dt, it arrives on the straight line without overshoot
/// from rest, and within the limits from any velocity.
Vec3 limitedVelocity(const Vec3& toTarget, const Vec3& velocity, const MotionLimits& limits,
                     double dt);

/// Axis times angle of the shortest rotation that `q` stands for [rad]; q and -q are the same one.
Vec3 rotationVector(const Quat& q);

/// `orientation` after turning at `angularVelocity` [rad/s] (in the world's axes) for `dt`.
Quat turned(const Quat& orientation, const Vec3& angularVelocity, double dt);

}  // namespace cloth_sim
