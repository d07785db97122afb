#pragma once
/// \file Parts of position-based methods: prediction of positions, loads, velocities.

#include "substep.h"

namespace cloth_sim {

/// Sets `particles.start` to the positions at the start of a substep before the first one, from
/// the velocities. `predictPositions` then finds velocities as displacements.
void beginPrediction(Substep& now);

/// Replaces positions by those that particles would reach without springs and contacts: `start`
/// becomes where they were. Loads act on where particles were.
/// \param decay        factor by which drag reduces a velocity in a substep.
/// \param inverseMass  inertia of each particle [1/kg]; gravity acts alike on all that are free.
void predictPositions(Substep& now, double decay, const ScalarArray& inverseMass);

/// Velocities are displacements in the substep over h.
void findVelocities(Substep& now);

}  // namespace cloth_sim
