#pragma once
/// \file A snapshot of the cloth with figures of its run. No ROS in here.

#include <memory>
#include <vector>

#include "cloth_sim/scene/phase_script.h"
#include "cloth_sim/sim/command.h"
#include "cloth_sim/sim/snapshot.h"

namespace cloth_sim {

/// The observable state of a run. A copy is cheap because the snapshots are shared.
struct Observation {
  std::shared_ptr<const Snapshot> snapshot;  ///< the newest
  std::shared_ptr<const Snapshot> whole;     ///< the newest that has figures
  std::vector<PhaseRecord> phases;
  bool paused = false;
  double realTimeFactor = 0.0;       ///< simulated over wall time, over the last half second [-]
  double realTimeFactorAsked = 1.0;  ///< requested factor [-]; 0: as fast as possible
  double stepTime = 0.0;             ///< wall time per step, mean over the same time [s]
  double stepCpuTime = 0.0;  ///< CPU time of the steps of the stepping thread since the start [s]
  double substep = 0.0;      ///< present length h of a substep [s]
  std::uint64_t resets = 0;  ///< since the start
  std::uint64_t droppedCommands = 0;  ///< commands refused because the queue was full
  std::uint64_t number = 0;           ///< increases with every observation
  std::uint64_t wholeNumber = 0;      ///< number of the observation with `whole`
};

/// Springs that failed, in order.
struct FailureBatch {
  std::uint64_t resets = 0;  ///< number of resets before their run
  /// Failures before a saved state that was loaded, in the first batch after it; they were reported
  /// when they happened.
  std::vector<FailureEvent> before;
  std::vector<FailureEvent> events;
};

/// An executed command with its time.
struct CommandRecord {
  std::uint64_t number = 0;  ///< from 0, since the start of the program
  std::uint64_t step = 0;    ///< number of steps before it
  double time = 0.0;         ///< simulated time of its execution [s]
  Command command;
};

}  // namespace cloth_sim
