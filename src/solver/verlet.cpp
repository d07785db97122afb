#include "explicit_forces.h"
#include "methods.h"

namespace cloth_sim {
namespace {

/// Position Verlet: half a drift, a kick with the forces there, half a drift.
///
/// Second order and time-reversible without damping (Tuckerman, Berne & Martyna 1992, eq. 2.22);
/// stable for h below 2 / omega_max. Dashpots see the velocity before the kick, which makes the
/// damping, and only that, first order. A displacement at the end of the substep stands for an
/// impulse at its middle of twice its size over h; contacts bring one half of it, a second pass
/// over the velocities the other, so that impacts do not bounce.
void advanceVerlet(Substep& now, const ExplicitForces& forces) {
  const double half = 0.5 * now.h;
  now.markStart();
  forces.damp(now, half);
  forces.drift(now, half);
  forces.evaluate(now);
  forces.kick(now);
  forces.drift(now, half);
  forces.damp(now, half);
  now.placeKinematic();
  now.enforceContacts();
  now.enforceContactVelocities();
}

}  // namespace

SolverInfo verletInfo() {
  SolverInfo info;
  info.name = "verlet";
  info.title = "Position Verlet (drift, kick, drift)";
  info.reference = "Tuckerman, Berne & Martyna, J. Chem. Phys. 97 (1992), eq. 2.22";
  info.limitations = "diverges for substeps longer than 2 / omega_max; first order in damping";
  info.order = 2;
  info.stabilityLimit = 2.0;
  info.parameters = {substepsParameter(64)};
  info.create = [](const Model& model, const SolverParameters& p) -> std::unique_ptr<Solver> {
    return makeExplicitSolver(model, p, advanceVerlet);
  };
  return info;
}

}  // namespace cloth_sim
