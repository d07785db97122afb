#include "explicit_forces.h"
#include "methods.h"

namespace cloth_sim {
namespace {

/// Forward (explicit) Euler: x += h v; v += h a(x, v), both from the start of the substep.
///
/// First order. Gains energy at any step without damping: each oscillation grows by the factor
/// sqrt(1 + (omega h)^2) per substep; with the damping ratio zeta it is stable for
/// h < 2 zeta / omega only (Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I,
/// 1993, ch. I.7; Baraff & Witkin 1998 for why cloth needs better).
void advanceExplicitEuler(Substep& now, const ExplicitForces& forces) {
  now.markStart();
  forces.evaluate(now);
  forces.drift(now, now.h);
  forces.damp(now, now.h);
  forces.kick(now);
  now.placeKinematic();
  now.enforceContacts();
  now.enforceContactVelocities();
}

}  // namespace

SolverInfo explicitEulerInfo() {
  SolverInfo info;
  info.name = "explicit_euler";
  info.title = "Forward (explicit) Euler";
  info.reference = "Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, ch. I.7";
  info.limitations =
      "gains energy at any step without damping; with it, stable below 2 zeta / omega only";
  info.order = 1;
  info.noLayers = "it amplifies each push";
  info.stabilityLimit = 0.0;
  info.parameters = {substepsParameter(64)};
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return makeExplicitSolver(model, p, advanceExplicitEuler);
  };
  return info;
}

}  // namespace cloth_sim
