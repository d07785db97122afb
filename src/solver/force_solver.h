#pragma once
/// \file Shared parts of the methods that integrate forces explicitly.

#include "cloth_sim/solver/packed_solver.h"

namespace cloth_sim {

/// Evaluates forces, and kicks and drifts particles.
class ForceSolver : public PackedSolver {
 protected:
  using PackedSolver::PackedSolver;

  /// `force_` = springs, dashpots and wind at the current positions and velocities.
  void evaluateForces(const Substep& now);
  /// v += h (f / m + g) for free particles; reactions for the others.
  void kick(const Substep& now);
  /// x += h v.
  void drift(double h);
  /// v *= exp(-drag h): exact for linear drag.
  void damp(const Controls& controls, double h);
};

}  // namespace cloth_sim
