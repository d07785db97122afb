#pragma once
/// \file Forces of springs and dashpots, for methods that integrate forces.

#include "particles.h"
#include "spring_schedule.h"

namespace cloth_sim {

/// Adds the force of every spring, f = -(k (l - l0) + c dl/dt) along it [N], to `force` by slot.
void addSpringForces(const SpringSchedule& schedule, const VectorArray& x, const VectorArray& v,
                     VectorArray& force);

/// Adds the force of one spring.
void addSpringForce(const SpringSchedule::Element& spring, const VectorArray& x,
                    const VectorArray& v, VectorArray& force);

/// The sum of 1/2 k (l - l0)^2 + tau/2 c (dl/dt)^2 over all springs [J]: the part of springs and
/// dashpots in the incremental potential of an implicit stage of length tau [s].
double springPotential(const SpringSchedule& schedule, const VectorArray& x, const VectorArray& v,
                       double tau);

}  // namespace cloth_sim
