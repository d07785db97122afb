#pragma once
/// \file Rotations as vectors. Those so small that their norm is rounded to zero count as none.

#include "cloth_sim/types.h"

namespace cloth_sim {

/// Returns axis times angle of the shortest rotation that `q` (or -q, the same one) stands for
/// [rad].
Vec3 rotationVector(const Quat& q);

/// Returns `orientation` after turning at `angularVelocity` [rad/s], in the axes of the world, for
/// `dt` [s].
Quat turned(const Quat& orientation, const Vec3& angularVelocity, double dt);

}  // namespace cloth_sim
