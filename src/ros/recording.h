#pragma once
/// \file Recording of a run, as a bag holds it: the scene, the commands, and the states. This
/// header includes no ROS header, so that tools can use it.

#include <functional>
#include <string>
#include <vector>

#include "cloth_sim/ros/observation.h"
#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {

/// A run as a bag of the node or of cloth_run has it.
struct Recording {
  std::string scene;                    ///< its text
  std::vector<CommandRecord> commands;  ///< by number, from 0 without a gap
  struct State {
    std::uint64_t step = 0;
    double time = 0.0;  ///< simulated [s]
    std::string hash;   ///< as hashText writes it
  };
  std::vector<State> states;  ///< in the order of the bag, at least one
};

/// \throws std::runtime_error in one line: no bag, no scene or no state in it, commands missing, or
///         more than one node.
Recording readRecording(const std::string& bag);

/// Result of replaying a recording: how many states were the same.
struct Replay {
  std::size_t same = 0;    ///< recorded states that were reproduced
  std::string difference;  ///< about the first that did not; "" if all did
};

/// Makes the steps and carries out the commands of `recording`.
/// \param simulation  of its scene, at the start.
/// \param onStep  called after every step; says whether to go on.
Replay replay(const Recording& recording, Simulation& simulation,
              const std::function<bool()>& onStep);

}  // namespace cloth_sim
