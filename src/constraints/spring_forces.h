#pragma once
/// \file Forces of springs and dashpots, for methods that integrate forces.

#include "particles.h"
#include "spring_schedule.h"

namespace cloth_sim {

/// Adds to `force` the force of every spring, f = -(k (l - l0) + c dl/dt) along it [N].
void addSpringForces(const SpringSchedule& schedule, const VectorArray& x, const VectorArray& v,
                     VectorArray& force);

/// The same for one spring.
void addSpringForce(const SpringSchedule::Element& spring, const VectorArray& x,
                    const VectorArray& v, VectorArray& force);

/// Sum of 1/2 k (l - l0)^2 + tau/2 c (dl/dt)^2: its change along the motion x' = v is what springs
/// and dashpots take in the time tau, for methods that search along a line [J].
double springPotential(const SpringSchedule& schedule, const VectorArray& x, const VectorArray& v,
                       double tau);

}  // namespace cloth_sim
