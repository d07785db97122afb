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

/// The summary of a run as indented JSON text. Always valid JSON: a number that is not finite is
/// written as null.
/// \param wallTime     what the run took [s].
/// \param interrupted  somebody stopped it before its end.
std::string summaryJson(const Simulation& simulation, const InitialFigures& initial,
                        double wallTime, bool interrupted = false);

}  // namespace cloth_sim
