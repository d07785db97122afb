#pragma once
/// \file Runs with a goal. No ROS in here.

#include <functional>
#include <string>
#include <variant>

#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {

/// Goal: some simulated time has passed.
struct RunFor {
  double duration = 0.0;  ///< [s]
};
/// Goal: a phase has begun.
struct RunToPhase {
  std::string phase;
};
using RunGoal = std::variant<RunFor, RunToPhase>;

/// The end of a run.
struct RunResult {
  enum class Outcome { kReached, kCancelled, kFailed };
  Outcome outcome = Outcome::kReached;
  std::string message;  ///< reason, one sentence
  std::uint64_t step = 0;
  double time = 0.0;       ///< simulated [s]
  std::uint64_t hash = 0;  ///< stateHash
};

/// A run in progress.
class RunJob {
 public:
  /// Receives the result, once, in the simulation thread; must not block.
  using Answer = std::function<void(const RunResult&)>;

  RunJob(RunGoal goal, Answer answer) : goal_(std::move(goal)), answer_(std::move(answer)) {}

  /// Records the start of the run.
  void begin(const Simulation& simulation);
  /// Tells whether the goal is reached or out of reach.
  bool isOver(const Simulation& simulation) const;
  /// Reports the result of a run that is over.
  void answer(const Simulation& simulation) const;
  /// Reports another end of the run.
  void finish(RunResult::Outcome outcome, const std::string& message,
              const Simulation& simulation) const;

 private:
  bool isReached(const Simulation& simulation) const;
  /// Returns why the script as it goes on does not come to the phase; empty if it may.
  std::string outOfReach(const Simulation& simulation) const;

  RunGoal goal_;
  Answer answer_;
  double end_ = 0.0;  ///< simulated time at which RunFor ends [s]
};

}  // namespace cloth_sim
