#include "implicit_solver.h"
#include "methods.h"

namespace cloth_sim {
namespace {

/// Backward (implicit) Euler: x1 = x0 + h v1, v1 = v0 + h a(x1, v1).
///
/// First order, stable at any step (Baraff & Witkin 1998, with Newton's method to the end instead
/// of one step). Damps what is fast: an oscillation shrinks by 1 / sqrt(1 + (omega h)^2) in a
/// substep.
class ImplicitEuler final : public ImplicitSolver {
 public:
  ImplicitEuler(const Model& model, const SolverParameters& parameters)
      : ImplicitSolver(model, parameters) {}

 private:
  void substep(const Substep& now) override {
    markStart();
    velocity_ = particles_.v;
    solveStage(now, now.h, now.fraction, particles_.start, velocity_);
    addForcesToReactions(now.h);
    enforceContacts(now);
  }

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
  info.parameters = implicitParameters();
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return std::make_unique<ImplicitEuler>(model, p);
  };
  return info;
}

}  // namespace cloth_sim
