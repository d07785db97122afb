#include "methods.h"
#include "newton_stage.h"
#include "substep_solver.h"

namespace cloth_sim {
namespace {

/// Backward (implicit) Euler: x1 = x0 + h v1, v1 = v0 + h a(x1, v1).
///
/// First order, stable at any step (Baraff & Witkin 1998, with Newton's method to the end instead
/// of one step). Damps what is fast: an oscillation shrinks by 1 / sqrt(1 + (omega h)^2) in a
/// substep.
class ImplicitEuler final : public SubstepMethod {
 public:
  explicit ImplicitEuler(const SolverParameters& parameters) : newton_(parameters) {}

  void begin(Substep& now) override { newton_.begin(now); }
  void advance(Substep& now) override {
    now.markStart();
    velocity_ = now.particles.v;
    newton_.advanceBackward(now, velocity_);
  }

 private:
  NewtonStage newton_;
  VectorArray velocity_;  ///< at the start of the substep [m/s]
};

}  // namespace

SolverInfo implicitEulerInfo() {
  SolverInfo info;
  info.name = "implicit_euler";
  info.title = "Backward (implicit) Euler";
  info.reference = "Baraff & Witkin, Large Steps in Cloth Simulation, 1998";
  info.limitations = "damps motion that is fast against the substep; contact follows the solve";
  info.order = 1;
  info.hasBendFriction = true;
  info.parameters = implicitParameters();
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return std::make_unique<SubstepSolver>(model, substepsOf(p),
                                           std::make_unique<ImplicitEuler>(p));
  };
  return info;
}

}  // namespace cloth_sim
