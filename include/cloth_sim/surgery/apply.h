#pragma once
/// \file Carries out planned openings.

#include "cloth_sim/surgery/tearing.h"

namespace cloth_sim {

struct SurgeryResult {
  ModelChanges changes;
  std::vector<FailureEvent> events;  ///< each failed spring once
};

/// Opens the surface, and brings masses, springs and the state along. Mass, rest area, linear and
/// angular momentum stay what they were; no face is lost.
SurgeryResult openSurface(Model& model, State& state, const std::vector<Opening>& openings,
                          FailureCause cause);

}  // namespace cloth_sim
