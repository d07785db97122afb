#pragma once
/// \file The phases of a scene's script at work in a simulation.

#include "cloth_sim/sim/simulation_parts.h"

namespace cloth_sim {

/// Starts the script, or goes on to the next phase once the current one has ended. Sets
/// `parts.failure` if a phase does not end in time, or its edits cannot be made.
void runScript(SimulationParts& parts);

/// Carries out the actions with which `phase` begins.
void beginPhase(const PhaseSpec& phase, SimulationParts& parts);

}  // namespace cloth_sim
