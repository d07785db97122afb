#pragma once
/// \file Running until something has happened. No ROS in here.

#include <functional>
#include <string>
#include <variant>

#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {

/// Until this much simulated time has passed [s].
struct RunFor {
  double duration = 0.0;
};
/// Until a phase has begun.
struct RunToPhase {
  std::string phase;
};
using RunGoal = std::variant<RunFor, RunToPhase>;

/// How a run ended, and where.
struct RunResult {
  enum class Outcome { kReached, kCancelled, kFailed };
  Outcome outcome = Outcome::kReached;
  std::string message;  ///< why, in one sentence
  std::uint64_t step = 0;
  double time = 0.0;       ///< simulated [s]
  std::uint64_t hash = 0;  ///< stateHash
};

/// A goal at work.
class RunJob {
 public:
  /// Called once, from the simulation thread; must not block.
  using Answer = std::function<void(const RunResult&)>;

  RunJob(RunGoal goal, Answer answer) : goal_(std::move(goal)), answer_(std::move(answer)) {}

  /// Takes note of where the run starts.
  void begin(const Simulation& simulation);
  /// Whether the goal is reached or cannot be any more.
  bool isOver(const Simulation& simulation) const;
  /// Tells which of it, when it is over.
  void answer(const Simulation& simulation) const;
  /// Tells that it ends otherwise.
  void finish(RunResult::Outcome outcome, const std::string& message,
              const Simulation& simulation) const;

 private:
  bool isReached(const Simulation& simulation) const;

  RunGoal goal_;
  Answer answer_;
  double end_ = 0.0;  ///< simulated [s], of RunFor
};

}  // namespace cloth_sim
