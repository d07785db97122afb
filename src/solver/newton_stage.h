#pragma once
/// \file One implicit stage, solved by Newton's method.

#include "cloth_sim/solver/registry.h"
#include "constraints/bend_friction.h"
#include "linalg/bend_matrix.h"
#include "linalg/block_jacobi.h"
#include "linalg/conjugate_gradients.h"
#include "substep.h"

namespace cloth_sim {

/// An equation of the form
///     x = fromX + tau v,   m (v - fromV) = tau (f(x, v) + m (g - drag v))
/// for the velocities v at the end of the stage.
struct ImplicitStage {
  double tau = 0.0;       ///< [s]
  double fraction = 0.0;  ///< of the step that has passed at the stage's positions
  const VectorArray& fromX;
  const VectorArray& fromV;
};

/// Solves implicit stages by Newton's method on the velocities, with conjugate gradients inside
/// (Baraff & Witkin 1998, eq. 15, iterated) and steps that are halved until the incremental
/// potential falls. Sliders of bending friction move at the end of a backward Euler step. f are
/// springs, dashpots, bending and loads; loads are those at the start of the stage.
class NewtonStage {
 public:
  /// \param parameters  `iterations` and `tolerance`, see `implicitParameters`.
  explicit NewtonStage(const SolverParameters& parameters);

  /// Rebuilds what depends on the model, if that is new.
  void begin(const Substep& now);
  /// Solves a stage, starting from the velocities in `now.particles`. Leaves positions and
  /// velocities there and forces in `now.force`.
  void solve(Substep& now, const ImplicitStage& stage);
  /// Advances a whole substep by backward Euler and enforces contacts.
  /// \param velocity  at the start of the substep, as is `now.particles.start` [m/s].
  void advanceBackward(Substep& now, const VectorArray& velocity);
  /// `now.force` = springs, dashpots, bending and loads at the present positions and velocities.
  void evaluateForces(Substep& now);

 private:
  void addInternalForces(Substep& now) const;
  void findLoads(Substep& now);
  double findResidual(Substep& now, const ImplicitStage& stage);
  void balance(Substep& now, const ImplicitStage& stage) const;
  double potential(const Substep& now, const ImplicitStage& stage) const;
  void linearise(Substep& now, double tau);
  void multiply(const SpringConstraints& springs, const VectorArray& p, VectorArray& q) const;
  void solveLinear(const Substep& now);
  void search(Substep& now, const ImplicitStage& stage);

  BendMatrix bending_;
  BendFriction friction_;
  BendMatrix slipBound_;     ///< at least the stiffness of `friction_`, for the linearised equation
  int iterations_;           ///< of Newton's method, at most
  double tolerance_;         ///< of the residual [m/s^2]
  ScalarArray diagonal_;     ///< m (1 + tau drag), by slot [kg]; 0: prescribed motion
  double bendFactor_ = 0.0;  ///< of the bending matrix in the linearised equation
  double slipFactor_ = 0.0;  ///< of the bound on the stiffness of its friction
  BlockJacobi preconditioner_;
  ConjugateGradients solver_;
  VectorArray loads_, residual_, change_, before_;
};

/// `substeps`, `iterations`, `tolerance`.
std::vector<SolverParameter> implicitParameters();

}  // namespace cloth_sim
