#pragma once
/// \file Reads the payload of a saved state.

#include <string>

#include "cloth_sim/sim/simulation_parts.h"

namespace cloth_sim {

/// Treatment of the hash of the positions, velocities and faces at the end of a saved state.
enum class StateHash : std::uint8_t {
  kChecked,
  kIgnored,  ///< for tests: a changed payload is judged by its contents
};

/// Returns the simulation whose saved state has this payload (see `sealState`).
/// \throws StateError if the bytes are damaged, contradict themselves, or are of another scene.
SimulationParts loadPayload(const std::string& payload, const SimulationParts& like,
                            StateHash stateHash);

}  // namespace cloth_sim
