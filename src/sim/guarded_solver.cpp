#include "cloth_sim/sim/guarded_solver.h"

namespace cloth_sim {
namespace {

std::unique_ptr<Solver> makeSolver(const SolverSpec& spec, const Model& model, const State& state) {
  const SolverInfo& info = findSolver(spec.method);
  if (spec.realTimeBudget && *spec.realTimeBudget == 0) {
    throw std::invalid_argument(
        "solver.budget: real_time is not resolved: load the scene by loadForThisMachine");
  }
  checkFeatures(info, !model.bending.empty());
  if (model.bending.hasFriction()) checkBendFriction(info);
  const SolverParameters complete = completeParameters(info, spec.parameters);
  if (spec.guard == StepGuard::kAllow) return info.create(model, complete);
  const FastestMode mode = estimateFastestMode(model, state);
  return info.create(model, guardStep(spec.guard, info, mode, spec.dt, complete));
}

/// Lists what holds particles in the rest of the step, and the lengths at which springs fail.
void gatherControls(const SteppedCloth& cloth) {
  cloth.holders.gatherControls(cloth.model, cloth.controls);
  cloth.tearing.listLimits(cloth.model, cloth.state, cloth.controls.limits);
}

}  // namespace

GuardedSolver::GuardedSolver(const SolverSpec& spec, const Model& model, const State& state)
    : solver_(makeSolver(spec, model, state)),
      watch_(spec, solver_->substeps()),
      meetsSharpFeatures_(findSolver(spec.method).meetsSharpFeatures) {}

StepStatus GuardedSolver::advance(const StepLength& length, const SteppedCloth& cloth) {
  gatherControls(cloth);
  if (mayTakeBack(cloth)) copyState(cloth.state, start_);
  watch_.begin(cloth.model, cloth.state, cloth.controls, cloth.obstacles.colliders(),
               length.left());
  for (int factor = 1; factor <= watch_.maxSubstepFactor(); factor *= 2) {
    if (factor > 1) watch_.noteRedone(cloth.state.t, factor);
    const StepStatus status =
        attempt({length.dt, factor * length.substepFactor, length.done, length.stop}, cloth);
    if (status == StepStatus::kOk) watch_.accept();
    if (status != StepStatus::kDiverged) return status;
    takeBack(cloth);
  }
  return StepStatus::kDiverged;
}

/// Solves once, and again for as long as clamps begin to slip: at least one more each time, so it
/// ends. So does a cloth that comes near itself unexpectedly, once. A jump of the energy counts as
/// divergence.
StepStatus GuardedSolver::attempt(const StepLength& length, const SteppedCloth& cloth) {
  StepPart part = length.done > 0.0 ? StepPart::kRest : StepPart::kWhole;
  while (true) {
    cloth.obstacles.detect(cloth.model, cloth.state, length.left(), meetsSharpFeatures_);
    cloth.obstacles.contacts().layers = cloth.layers;
    if (cloth.layers != nullptr) cloth.layers->beginStep(cloth.model, part);
    report_ =
        solver_->step(cloth.model, cloth.state, cloth.controls, cloth.obstacles.contacts(), length);
    if (report_.status == StepStatus::kStopped) return report_.status;
    if (report_.status == StepStatus::kCameNear) {
      part = StepPart::kAgain;
      continue;
    }
    if (!watch_.endedWell(cloth.model, cloth.state, report_.status)) return StepStatus::kDiverged;
    if (!cloth.holders.yield(cloth.controls, report_)) return StepStatus::kOk;
    takeBack(cloth);
    gatherControls(cloth);
  }
}

/// Tells whether a step may be taken back that the method has carried out: for its energy, or
/// because a grip gives way. (A step that diverges leaves the state alone.)
bool GuardedSolver::mayTakeBack(const SteppedCloth& cloth) const {
  return watch_.checksEnergy() || cloth.holders.mayYield();
}

void GuardedSolver::takeBack(const SteppedCloth& cloth) {
  if (mayTakeBack(cloth)) copyState(start_, cloth.state);
}

}  // namespace cloth_sim
