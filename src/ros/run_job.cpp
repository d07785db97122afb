#include "run_job.h"

namespace cloth_sim {

void RunJob::begin(const Simulation& simulation) {
  if (const auto* goal = std::get_if<RunFor>(&goal_)) end_ = simulation.time() + goal->duration;
}

bool RunJob::isOver(const Simulation& simulation) const {
  const bool ended = std::holds_alternative<RunToPhase>(goal_) &&
                     simulation.script().status() == ScriptStatus::kDone;
  return simulation.failed() || ended || isReached(simulation);
}

void RunJob::answer(const Simulation& simulation) const {
  using Outcome = RunResult::Outcome;
  if (simulation.failed()) {
    finish(Outcome::kFailed, "the simulation has failed: " + simulation.failure(), simulation);
  } else if (isReached(simulation)) {
    finish(Outcome::kReached, "done", simulation);
  } else {
    finish(Outcome::kFailed, "the script has ended without that phase", simulation);
  }
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
