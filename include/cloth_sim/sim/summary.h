#pragma once
/// \file The result of a run as JSON.

#include <string>

#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {

/// What the simulation looked like before its first step.
struct InitialFigures {
  double mass = 0.0;      ///< [kg]
  double restArea = 0.0;  ///< [m^2]
};
InitialFigures initialFigures(const Simulation& simulation);

/// The summary that the contract names (docs/cloth_run.md), as indented JSON text. Always valid
/// JSON: a number that is not finite is written as null.
std::string summaryJson(const Simulation& simulation, const InitialFigures& initial,
                        double wallTime);

}  // namespace cloth_sim
