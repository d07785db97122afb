#pragma once
/// \file Parts of position-based methods: prediction of positions, loads, bending, velocities.

#include "constraints/bend_friction.h"
#include "constraints/bend_projection.h"
#include "linalg/bend_matrix.h"
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
///
/// Where the impulse n h^2 W K y of bending at the predicted positions y, K its stiffness matrix
/// and W the inverse inertia, moves no mode of the cloth by more than most of its amplitude, it is
/// given at once: that is stable, and takes the forces of bending as they are. Elsewhere, on fine
/// grids of stiff fabrics and beside slivers, elements are projected one after the other with their
/// compliance, which is stable for any stiffness.
class PlateProjection {
 public:
  bool empty() const { return matrix_.empty(); }
  /// Follows what depends on the model. A model without bending energy takes no time.
  void build(const Substep& now);
  /// Prepares for substeps, and for the particles that are held.
  /// \param longest  most substeps whose impulse bending gives at once (multiple time stepping).
  ///                 It gives that of one where it is stiff: between two impulses cloth flies on,
  ///                 and what is faster than that would bounce without end.
  void setStep(Substep& now, int longest);
  /// Substeps whose impulse bending gives at once, at most `longest`.
  int interval() const { return step_.interval; }
  /// Gives the impulse, with friction if there is any, and adds what held particles bear.
  /// \param inverseInertia  of each particle [1/kg]; 0: held.
  void project(const ScalarArray& inverseInertia, Substep& now) const;

 private:
  bool isStable(int interval) const;
  void setElements(const Substep& now, int longest);
  void displace(const ScalarArray& inverseInertia, Substep& now) const;
  void projectElements(const ScalarArray& inverseInertia, Substep& now) const;

  BendMatrix matrix_;
  BendProjection elements_;
  BendFriction friction_;
  BendStep step_;             ///< that all are prepared for
  double stiffest_ = 0.0;     ///< bound on the eigenvalues of W K [1/s^2]
  bool isAtOnce_ = false;     ///< whether all impulses are given at once
  bool hasElements_ = false;  ///< whether `elements_` follow the model
};

/// Velocities are displacements in the substep over h.
void findVelocities(Substep& now);

}  // namespace cloth_sim
