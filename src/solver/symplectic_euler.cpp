#include "explicit_forces.h"
#include "methods.h"

namespace cloth_sim {
namespace {

/// Symplectic (semi-implicit) Euler: v += h a(x, v); x += h v.
///
/// First order; stable for h below 2 / omega_max without damping (Hairer, Lubich & Wanner 2006,
/// ch. VI.3). Cheap per substep, but stiff fabric needs very many of them.
void advanceSymplecticEuler(Substep& now, const ExplicitForces& forces) {
  now.markStart();
  forces.evaluate(now);
  forces.kick(now);
  forces.damp(now, now.h);
  forces.drift(now, now.h);
  now.placeKinematic();
  now.enforceContacts();
}

}  // namespace

SolverInfo symplecticEulerInfo() {
  SolverInfo info;
  info.name = "symplectic_euler";
  info.title = "Symplectic (semi-implicit) Euler";
  info.reference = "Hairer, Lubich & Wanner, Geometric Numerical Integration, 2006, ch. VI.3";
  info.limitations =
      "diverges for substeps longer than 2 / omega_max; dashpots shorten that further";
  info.order = 1;
  info.stabilityLimit = 2.0;
  info.parameters = {substepsParameter(64)};
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return makeExplicitSolver(model, p, advanceSymplecticEuler);
  };
  return info;
}

}  // namespace cloth_sim
