#pragma once
/// \file What the implicit methods share: one stage, solved by Newton's method.

#include "cloth_sim/solver/registry.h"
#include "linalg/bend_matrix.h"
#include "linalg/spring_matrix.h"
#include "substep_solver.h"

namespace cloth_sim {

/// Solves stages of the form
///     x = x* + tau v,   m (v - v*) = tau (f(x, v) + m (g - drag v))
/// for v, by Newton's method on the velocities with conjugate gradients inside (Baraff & Witkin
/// 1998, eq. 15, iterated), and steps that are halved until the incremental potential falls. f are
/// springs, dashpots and wind; the wind is that of the start of the stage.
class ImplicitSolver : public SubstepSolver {
 protected:
  ImplicitSolver(const Model& model, const SolverParameters& parameters);

  /// Solves a stage from `fromX` and `fromV`, starting from the velocities in `particles_`; leaves
  /// the stage in `particles_` and its forces in `force_`.
  /// \param fraction  of the step that has passed at the stage's positions.
  void solveStage(const Substep& now, double tau, double fraction, const VectorArray& fromX,
                  const VectorArray& fromV);

  /// Springs, dashpots and wind at the present positions and velocities, in `force_`.
  void evaluateForces(const Substep& now);

 private:
  void addInternalForces();
  void findWind(const Substep& now);
  void balance(double tau, double fraction, const VectorArray& fromX);
  void place(double tau, double fraction, const VectorArray& fromX);
  double findResidual(const Substep& now, double tau, const VectorArray& fromV);
  double potential(const Substep& now, double tau, const VectorArray& fromV) const;
  void search(const Substep& now, double tau, double fraction, const VectorArray& fromX,
              const VectorArray& fromV);

  void loadBending(const Model& model) final { bending_.build(model, particles_); }

  BendMatrix bending_;
  int iterations_;    ///< of Newton's method, at most
  double tolerance_;  ///< of the residual [m/s^2]
  SpringMatrix matrix_;
  ScalarArray diagonal_;
  VectorArray wind_, residual_, change_, before_;
};

/// `substeps`, `iterations`, `tolerance`.
std::vector<SolverParameter> implicitParameters();

}  // namespace cloth_sim
