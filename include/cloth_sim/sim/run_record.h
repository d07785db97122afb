#pragma once
/// \file The record of a run, for its summary.

#include <optional>
#include <string>
#include <vector>

#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {

/// The moment at which the cloth came apart into more pieces than at the start of the run.
struct Separation {
  double time = 0.0;        ///< simulated [s]
  std::string phase;        ///< "" without a script
  double phaseStart = 0.0;  ///< simulated [s]; 0 without a script
};

/// The largest force of the cloth on a clamp, as means over steps.
struct PeakForce {
  std::string clamp;
  double force = 0.0;  ///< [N]
  double time = 0.0;   ///< simulated [s]
};

/// Initial values and extremes of a run.
struct RunRecord {
  double initialMass = 0.0;      ///< at the start of the run [kg]
  double initialRestArea = 0.0;  ///< at the start of the run [m^2]
  int piecesAtStart = 0;         ///< number of pieces at the start of the run
  std::optional<Separation> separation;
  std::vector<PeakForce> peaks;  ///< in the order of appearance; also of removed clamps
};

/// Returns the record of a run that is about to start.
/// \param simulation  before its first step.
RunRecord startRecord(const Simulation& simulation);

/// Updates the record. To be called after every step.
void observe(const Simulation& simulation, RunRecord& record);

}  // namespace cloth_sim
