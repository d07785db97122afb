#pragma once
/// \file Parts of position-based methods: prediction of positions, loads, bending, velocities.

#include "constraints/bend_friction.h"
#include "constraints/bend_projection.h"
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

/// Bending of a plate, for methods that project constraints.
struct PlateProjection {
  BendProjection elastic;
  BendFriction friction;
  BendStep step;  ///< that both are prepared for

  bool empty() const { return elastic.empty(); }
  /// Rebuilds what depends on the model. A model without bending energy takes no time.
  void build(const Substep& now);
  /// Prepares for substeps, and for the particles that are held.
  /// \param longest  most substeps whose impulse bending gives at once (multiple time stepping).
  ///                 It gives that of one where it is stiff: between two impulses cloth flies on,
  ///                 and what is faster than that would bounce without end.
  void setStep(const Substep& now, int longest);

 private:
  double retardation_ = 0.0;  ///< dashpot over stiffness [s]
  double stiffest_ = 0.0;     ///< of an element, over its inertia [1/s^2]
};

/// Projects the elements of a bending energy and its friction, and adds what held particles bear.
/// \param inverseInertia  of each particle [1/kg]; 0: held.
void projectBending(const PlateProjection& bending, const ScalarArray& inverseInertia,
                    Substep& now);

/// Velocities are displacements in the substep over h.
void findVelocities(Substep& now);

}  // namespace cloth_sim
