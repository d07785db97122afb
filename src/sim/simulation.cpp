#include "cloth_sim/sim/simulation.h"

#include <cstdio>

#include "snapshot_parts.h"

namespace cloth_sim {
namespace {

/// Tells whether a command that was carried out ends the rest of the cloth.
bool wakesUp(Wakes wakes, const SimulationParts& parts) {
  return wakes == Wakes::kAlways || (wakes == Wakes::kIfSomethingMoves && !parts.isStill());
}

/// One line: when a step diverged, and why the step guard could not save it or what would.
std::string describeDivergence(const SimulationParts& parts) {
  const SolverSpec& solver = parts.scene.solver;
  const std::string start =
      solver.method + " diverged in the step from t = " + std::to_string(parts.state.t) + " s";
  if (solver.guard == StepGuard::kAllow) return start + ": take more substeps or a softer fabric";
  char reason[160];
  std::snprintf(reason, sizeof reason,
                " with %d substeps, the most that step_guard tries, too: springs are stretched to "
                "%.3g times their length there",
                parts.solver.guard().finest * parts.solver.substeps(),
                maxStretch(parts.model, parts.state));
  return start + reason;
}

template <typename SomeCommand>
CommandResult validateAndApply(const SomeCommand& command, SimulationParts& parts) {
  const std::string error = command.validationError();
  if (!error.empty()) return refuse(error);
  const CommandResult result = command.apply(parts);
  if (result.success && wakesUp(SomeCommand::kWakes, parts)) parts.sleep.wake();
  return result;
}

}  // namespace

CommandResult Simulation::apply(const Command& command) {
  return std::visit([this](const auto& it) { return validateAndApply(it, parts_); }, command);
}

void Simulation::step() {
  if (failed()) return;
  runScript(parts_);
  if (failed()) return;
  if (isAsleep()) return sleepThrough();
  const ThreadPool::ParallelRegion region(pool_);
  const int brokenBefore = broken().total;
  parts_.sleep.beginStep(state());
  parts_.holders.remember();
  parts_.holders.advance(model(), state(), parts_.dt(), parts_.layers.get());
  parts_.obstacles.steer(time(), parts_.dt());
  std::optional<double> done = 0.0;
  while (done && *done < 1.0) done = solveFrom(*done);
  if (!done) return;
  parts_.holders.holdBack(state(), parts_.dt(), parts_.layers.get());
  parts_.holders.recordGripEvents(model(), state(), colliders(), parts_.layers.get());
  ++parts_.stepCount;
  parts_.watch.observe(parts_.stepCount, model(), state(), parts_.controls, contacts(),
                       lastReport());
  watchRest(brokenBefore);
}

/// Lets time go on, and leaves everything else as it is.
void Simulation::sleepThrough() {
  parts_.state.t += parts_.dt();
  parts_.sleep.sleepOn(parts_.dt());
  ++parts_.stepCount;
}

/// Solves the rest of a step, or the part of it until springs fail, and tears the cloth there.
/// \param done  fraction of the step that has passed.
/// \return the fraction that has passed now; nothing if the simulation has failed or was stopped.
std::optional<double> Simulation::solveFrom(double done) {
  const double dt = parts_.dt();
  const StepStatus status = parts_.solver.advance({dt, 1.0, done, stop_}, parts_.steppedCloth());
  if (status == StepStatus::kDiverged) parts_.failure = describeDivergence(parts_);
  if (status == StepStatus::kStopped && done == 0.0) parts_.holders.takeBack();
  if (status != StepStatus::kOk) return std::nullopt;
  const StepReport& report = lastReport();
  const double fraction = report.fraction - done;
  parts_.holders.addReactions(parts_.controls, report, model(), state(), fraction);
  tear(report.passedLimit ? report.substep : fraction * dt);
  if (failed()) return std::nullopt;
  return report.fraction;
}

/// \param dt  how long springs may have been overloaded [s].
void Simulation::tear(double dt) {
  try {
    parts_.surgery.tear(dt, parts_.editedCloth());
  } catch (const TooManyParticles& error) {
    parts_.failure = std::string("tearing: ") + error.what();
  }
}

/// Falls asleep if the cloth has been at rest for long enough.
/// \param brokenBefore  number of springs that had failed before the step.
void Simulation::watchRest(int brokenBefore) {
  const bool rests = parts_.sleep.isSlow(state(), parts_.dt()) && parts_.isStill() &&
                     broken().total == brokenBefore;
  if (!parts_.sleep.endStep(rests, parts_.dt())) return;
  for (Vec3& v : parts_.state.v) v.setZero();
  parts_.measurements.fellAsleep();
}

double Simulation::observeMaxStretch() {
  return parts_.measurements.measureMaxStretch(model(), state(), isAsleep());
}

std::vector<PieceSnapshot> Simulation::describePieces() const {
  return cloth_sim::describePieces(model(), state(), parts_.surgery.pieces());
}

std::shared_ptr<const Snapshot> Simulation::snapshot(Detail detail, ContactDetail contacts) {
  return takeSnapshot(parts_, detail, contacts);
}

}  // namespace cloth_sim
