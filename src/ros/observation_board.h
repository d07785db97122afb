#pragma once
/// \file Everything that the simulation thread shows to other threads. Independent of ROS.

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "cloth_sim/ros/observation.h"

namespace cloth_sim {

/// The latest observation, and the events and commands that nobody has taken yet. Thread-safe.
class ObservationBoard {
 public:
  /// Replaces the latest observation. Numbers it; without figures (`whole` is null) it keeps the
  /// last ones.
  void show(Observation observation);
  /// Returns the latest observation.
  Observation latest() const;
  /// Waits until there is an observation newer than number `seen`, at most for `timeout`.
  void waitFor(std::uint64_t seen, std::chrono::duration<double> timeout) const;

  void addEvents(const std::vector<FailureEvent>& failures, const std::vector<GripEvent>& grips);
  /// Numbers a command that was carried out, and adds it.
  void addCommand(CommandRecord record);
  /// Replaces the failures by those of another run.
  void replaceFailures(FailureBatch failures);

  /// Each returns everything since its last call.
  FailureBatch takeFailures();
  std::vector<GripEvent> takeGripEvents();
  std::vector<CommandRecord> takeCommands();

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable shown_;
  Observation observation_;
  FailureBatch failures_;
  std::vector<GripEvent> gripEvents_;
  std::vector<CommandRecord> commands_;
  std::uint64_t commandCount_ = 0;  ///< so far
};

}  // namespace cloth_sim
