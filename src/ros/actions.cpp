#include "actions.h"

#include <stdexcept>
#include <utility>

#include "cloth_sim/validation.h"
#include "support/hash.h"

namespace cloth_sim {
namespace {

constexpr double kFeedbackPeriod = 0.1;  ///< wall time [s]
constexpr double kMaxDuration = 1e6;     ///< [s]

/// Returns the simulated time that a goal takes [s], 0 if it is not known.
double lengthOf(const RunGoal& goal) {
  const auto* runFor = std::get_if<RunFor>(&goal);
  return runFor == nullptr ? 0.0 : runFor->duration;
}

void setRemaining(double remaining, RunForFeedback& feedback) {
  feedback.remaining = std::max(0.0, remaining);
}
void setRemaining(double /*remaining*/, RunToPhaseFeedback& /*feedback*/) {}

RunGoal runFor(const RunForGoal& goal) {
  if (!isPositive(goal.duration) || goal.duration > kMaxDuration) {
    throw std::runtime_error("duration: expected a number > 0 and <= 1e6 s");
  }
  return RunFor{goal.duration};
}

RunGoal runToPhase(const RequestChecker& checker, const RunToPhaseGoal& goal) {
  const std::string error = checker.phaseError(goal.phase);
  if (!error.empty()) throw std::runtime_error(error);
  return RunToPhase{goal.phase};
}

}  // namespace

template <typename Action>
RunAction<Action>::RunAction(ros::NodeHandle& privateNode, const std::string& name, ToGoal toGoal,
                             SimulationThread& simulation)
    : toGoal_(std::move(toGoal)),
      simulation_(simulation),
      server_(
          privateNode, name, [this](Handle handle) { accept(handle); },
          [this](Handle handle) { cancel(handle); }, false),
      timer_(privateNode.createWallTimer(ros::WallDuration(kFeedbackPeriod),
                                         [this](const ros::WallTimerEvent&) { tellProgress(); })) {
  server_.start();
}

template <typename Action>
void RunAction<Action>::accept(Handle handle) {
  RunGoal goal;
  try {
    goal = toGoal_(*handle.getGoal());
  } catch (const std::runtime_error& error) {
    Result result;
    result.message = error.what();
    handle.setRejected(result, error.what());
    return;
  }
  handle.setAccepted();
  const std::string id = handle.getGoalID().id;
  // The answer comes from another thread, and waits for the entry in runs_.
  const std::lock_guard<std::mutex> lock(mutex_);
  const double end = simulation_.observe().snapshot->time + lengthOf(goal);
  const std::uint64_t number = simulation_.requestRun(
      goal, [this, handle](const RunResult& result) { finish(handle, result); });
  runs_[id] = {handle, number, end};
}

template <typename Action>
void RunAction<Action>::cancel(const Handle& handle) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto run = runs_.find(handle.getGoalID().id);
  if (run != runs_.end()) simulation_.cancelRun(run->second.number);
}

template <typename Action>
void RunAction<Action>::finish(Handle handle, const RunResult& result) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    runs_.erase(handle.getGoalID().id);
  }
  switch (result.outcome) {
    case RunResult::Outcome::kReached:
      handle.setSucceeded(resultOf(result), result.message);
      break;
    case RunResult::Outcome::kCancelled:
      handle.setCanceled(resultOf(result), result.message);
      break;
    case RunResult::Outcome::kFailed:
      handle.setAborted(resultOf(result), result.message);
      break;
  }
}

template <typename Action>
typename RunAction<Action>::Result RunAction<Action>::resultOf(const RunResult& result) {
  Result message;
  message.success = result.outcome == RunResult::Outcome::kReached;
  message.message = result.message;
  message.step = result.step;
  message.time = result.time;
  message.state_hash = hashText(result.hash);
  return message;
}

template <typename Action>
void RunAction<Action>::tellProgress() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (runs_.empty()) return;
  const Observation now = simulation_.observe();
  for (auto& [id, run] : runs_) {
    Feedback feedback;
    feedback.step = now.snapshot->step;
    feedback.time = now.snapshot->time;
    feedback.phase = now.snapshot->phase;
    feedback.paused = now.paused;
    setRemaining(run.end - now.snapshot->time, feedback);
    run.handle.publishFeedback(feedback);
  }
}

Actions::Actions(ros::NodeHandle& privateNode, const RequestChecker& checker,
                 SimulationThread& simulation)
    : runFor_(privateNode, "run_for", runFor, simulation),
      runToPhase_(
          privateNode, "run_to_phase",
          [&checker](const RunToPhaseGoal& goal) { return runToPhase(checker, goal); },
          simulation) {}

}  // namespace cloth_sim
