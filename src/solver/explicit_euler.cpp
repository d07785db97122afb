#include "explicit_solver.h"
#include "methods.h"

namespace cloth_sim {
namespace {

/// Forward (explicit) Euler: x += h v; v += h a(x, v), both from the start of the substep.
///
/// First order. Gains energy at any step without damping: each oscillation grows by the factor
/// sqrt(1 + (omega h)^2) per substep; with the damping ratio zeta it is stable for
/// h < 2 zeta / omega only (Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I,
/// 1993, ch. I.7; Baraff & Witkin 1998 for why cloth needs better).
class ExplicitEuler final : public ExplicitSolver {
 public:
  ExplicitEuler(const Model& model, int substeps) : ExplicitSolver(model, substeps) {}

 private:
  void substep(const Substep& now) override {
    markStart();
    evaluateForces(now);
    drift(now.h);
    damp(now.controls, now.h);
    kick(now);
    placeKinematic(now.fraction);
    enforceContacts(now);
    enforceContactVelocities(now);
  }
};

}  // namespace

SolverInfo explicitEulerInfo() {
  SolverInfo info;
  info.name = "explicit_euler";
  info.title = "Forward (explicit) Euler";
  info.reference = "Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, ch. I.7";
  info.limitations =
      "gains energy at any step without damping; with it, stable below 2 zeta / omega only";
  info.order = 1;
  info.stabilityLimit = 0.0;
  info.parameters = {substepsParameter(64)};
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return std::make_unique<ExplicitEuler>(model, static_cast<int>(p.at("substeps")));
  };
  return info;
}

}  // namespace cloth_sim
