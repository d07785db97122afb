#pragma once
/// \file Forces and the elementary moves of methods that integrate them explicitly.

#include <functional>

#include "cloth_sim/solver/registry.h"
#include "linalg/bend_matrix.h"
#include "substep.h"

namespace cloth_sim {

/// Evaluates forces, and kicks and drifts particles.
///
/// Surgery makes edges shorter, and shorter steps are stable then. `substepsFor` divides steps
/// further in the same proportion, so that a scene keeps the margin to the stability limit that it
/// began with.
class ExplicitForces {
 public:
  explicit ExplicitForces(const Model& model);

  /// Rebuilds what depends on the model, if that is new.
  void begin(const Substep& now);
  int substepsFor(const Model& model, int configured) const;

  /// `now.force` = springs, dashpots, bending and loads at the current positions and velocities.
  void evaluate(Substep& now) const;
  /// out = f / m + g - drag v for free particles, 0 for the others [m/s^2].
  void findAccelerations(const Substep& now, VectorArray& out) const;

  /// v += h (f / m + g) for free particles; the others pass their forces on to their holders.
  static void kick(Substep& now);
  /// x += duration v.
  static void drift(Substep& now, double duration);
  /// v *= exp(-drag duration): exact for linear drag.
  static void damp(Substep& now, double duration);

 private:
  BendMatrix bending_;
  double stableAtFirst_;  ///< stableStep of the undamaged model [s]
};

/// Advances a substep by forces alone.
using ExplicitScheme = std::function<void(Substep& now, const ExplicitForces& forces)>;

/// A solver that integrates by `scheme`.
/// \param parameters  complete; `substeps` is read.
std::unique_ptr<Solver> makeExplicitSolver(const Model& model, const SolverParameters& parameters,
                                           ExplicitScheme scheme);

}  // namespace cloth_sim
