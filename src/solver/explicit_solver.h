#pragma once
/// \file Shared parts of the methods that integrate forces explicitly.

#include "linalg/bend_matrix.h"
#include "substep_solver.h"

namespace cloth_sim {

/// Evaluates forces, and kicks and drifts particles.
///
/// Surgery makes edges shorter, and shorter steps are stable then. Substeps are divided further in
/// the same proportion, so that a scene keeps the margin to the limit that it began with.
class ExplicitSolver : public SubstepSolver {
 protected:
  ExplicitSolver(const Model& model, int substeps);

  /// `force_` = springs, dashpots and wind at the current positions and velocities.
  void evaluateForces(const Substep& now);
  /// v += h (f / m + g) for free particles; reactions for the others.
  void kick(const Substep& now);
  /// f / m + g - drag v for free particles, 0 for the others, with the forces last evaluated.
  void evaluateAccelerations(const Controls& controls, VectorArray& out) const;
  /// x += h v.
  void drift(double h);
  /// v *= exp(-drag h): exact for linear drag.
  void damp(const Controls& controls, double h);

  void loadBending(const Model& model) final { bending_.build(model, particles_); }
  int substepsFor(const Model& model, int configured) final;

 private:
  BendMatrix bending_;
  double stableAtFirst_;  ///< stableStep of the undamaged model [s]
};

}  // namespace cloth_sim
