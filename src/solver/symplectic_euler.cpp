#include "explicit_solver.h"
#include "methods.h"

namespace cloth_sim {
namespace {

/// Symplectic (semi-implicit) Euler: v += h a(x, v); x += h v.
///
/// First order; stable for h below 2 / omega_max without damping (Hairer, Lubich & Wanner 2006,
/// ch. VI.3). Cheap per substep, but stiff fabric needs very many of them.
class SymplecticEuler final : public ExplicitSolver {
 public:
  SymplecticEuler(const Model& model, int substeps) : ExplicitSolver(model, substeps) {}

 private:
  void substep(const Substep& now) override {
    markStart();
    evaluateForces(now);
    kick(now);
    damp(now.controls, now.h);
    drift(now.h);
    placeKinematic(now.fraction);
    enforceContacts(now);
  }
};

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
    return std::make_unique<SymplecticEuler>(model, static_cast<int>(p.at("substeps")));
  };
  return info;
}

}  // namespace cloth_sim
