#pragma once
/// \file Forces of springs and dashpots, for methods that integrate forces.

#include "cloth_sim/solver/packed_particles.h"
#include "cloth_sim/solver/spring_schedule.h"

namespace cloth_sim {

/// Adds to `force` the force of every spring, f = -(k (l - l0) + c dl/dt) along it [N].
void addSpringForces(const SpringSchedule& schedule, const PackedVectors& x, const PackedVectors& v,
                     PackedVectors& force);

}  // namespace cloth_sim
