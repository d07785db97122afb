#pragma once
/// \file What happened in a run, for its summary.

#include <optional>
#include <string>
#include <vector>

#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {

/// Since when the cloth is in more pieces than where the run began.
struct Separation {
  double time = 0.0;        ///< simulated [s]
  std::string phase;        ///< "" without a script
  double phaseStart = 0.0;  ///< simulated; 0 without a script [s]
};

/// The greatest force of the cloth on a clamp, mean over a step.
struct PeakForce {
  std::string clamp;
  double force = 0.0;  ///< [N]
  double time = 0.0;   ///< simulated [s]
};

struct RunRecord {
  double initialMass = 0.0;      ///< at the start of the scene [kg]
  double initialRestArea = 0.0;  ///< at the start of the scene [m^2]
  int piecesAtStart = 0;         ///< where the run begins
  std::optional<Separation> separation;
  std::vector<PeakForce> peaks;  ///< in the order of the clamps; those that were taken away, too
};

/// \param simulation  before its first step.
RunRecord startRecord(const Simulation& simulation);

/// To be called after every step.
void observe(const Simulation& simulation, RunRecord& record);

}  // namespace cloth_sim
