#include "run_job.h"

#include <algorithm>

namespace cloth_sim {

void RunJob::begin(const Simulation& simulation) {
  if (const auto* goal = std::get_if<RunFor>(&goal_)) end_ = simulation.time() + goal->duration;
}

bool RunJob::isOver(const Simulation& simulation) const {
  return simulation.failed() || isReached(simulation) || !outOfReach(simulation).empty();
}

void RunJob::answer(const Simulation& simulation) const {
  using Outcome = RunResult::Outcome;
  if (simulation.failed()) {
    finish(Outcome::kFailed, "the simulation has failed: " + simulation.failure(), simulation);
  } else if (isReached(simulation)) {
    finish(Outcome::kReached, "done", simulation);
  } else {
    finish(Outcome::kFailed, outOfReach(simulation), simulation);
  }
}

std::string RunJob::outOfReach(const Simulation& simulation) const {
  const auto* goal = std::get_if<RunToPhase>(&goal_);
  if (goal == nullptr) return "";
  const PhaseScript& script = simulation.script();
  if (script.status() == ScriptStatus::kDone) return "the script has ended without that phase";
  if (script.current() == nullptr) return "";
  const std::string& now = script.current()->name;
  const std::vector<std::string> names = script.names();
  const auto placeOf = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name);
  };
  if (placeOf(goal->phase) >= placeOf(now)) return "";
  return "phase '" + goal->phase + "' is past, the script is in '" + now +
         "'; ~set_phase or ~reset goes back";
}

bool RunJob::isReached(const Simulation& simulation) const {
  if (const auto* goal = std::get_if<RunToPhase>(&goal_)) {
    const PhaseSpec* phase = simulation.script().current();
    return phase != nullptr && phase->name == goal->phase;
  }
  return simulation.time() >= end_ - 0.5 * simulation.scene().solver.dt;
}

void RunJob::finish(RunResult::Outcome outcome, const std::string& message,
                    const Simulation& simulation) const {
  const std::uint64_t hash = stateHash(simulation.model(), simulation.state());
  answer_({outcome, message, simulation.stepCount(), simulation.time(), hash});
}

}  // namespace cloth_sim
