#pragma once
/// \file A snapshot of the cloth with the figures of the run that it belongs to. No ROS in here.

#include <memory>
#include <vector>

#include "cloth_sim/scene/phase_script.h"
#include "cloth_sim/sim/command.h"
#include "cloth_sim/sim/snapshot.h"

namespace cloth_sim {

/// What others may see of a run. A copy is cheap: the snapshots are shared.
struct Observation {
  std::shared_ptr<const Snapshot> snapshot;  ///< the newest
  std::shared_ptr<const Snapshot> whole;     ///< the newest with figures
  std::vector<PhaseRecord> phases;
  bool paused = false;
  double realTimeFactor = 0.0;       ///< simulated over wall time, lately [-]
  double realTimeFactorAsked = 1.0;  ///< 0: as fast as it can
  double stepTime = 0.0;             ///< wall time of one step, mean over the same time [s]
  double stepCpuTime = 0.0;  ///< that the stepping thread spent in steps, since the start [s]
  double substep = 0.0;      ///< of the method now [s]
  std::uint64_t resets = 0;  ///< since the start
  std::uint64_t droppedCommands = 0;  ///< refused because too many were waiting
  std::uint64_t number = 0;           ///< grows with every observation
  std::uint64_t wholeNumber = 0;      ///< of the observation that `whole` came with
};

/// Springs that failed, in order.
struct FailureBatch {
  std::uint64_t resets = 0;  ///< of the run that they failed in, since the start
  /// With the first batch of a run that goes on from a saved state: what had failed before, and was
  /// told then.
  std::vector<FailureEvent> before;
  std::vector<FailureEvent> events;
};

/// A command that was carried out, and between which steps.
struct CommandRecord {
  std::uint64_t number = 0;  ///< from 0, since the start of the program
  std::uint64_t step = 0;    ///< steps that had been made
  double time = 0.0;         ///< simulated, before it was carried out [s]
  Command command;
};

}  // namespace cloth_sim
