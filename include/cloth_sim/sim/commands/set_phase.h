#pragma once
/// \file The command to jump to a phase of the script.

#include "cloth_sim/sim/command_basics.h"
#include "cloth_sim/sim/phase_actions.h"

namespace cloth_sim {

/// Ends the current phase and begins the named one; the script goes on from there.
struct SetPhase {
  static constexpr const char* kKind = "set_phase";
  static constexpr Wakes kWakes = Wakes::kAlways;

  std::string phase;

  std::string describe() const { return phase; }
  std::string validationError() const { return ""; }
  CommandResult apply(SimulationParts& parts) const {
    const PhaseSpec* next = parts.script.jump(phase, parts.time());
    if (next == nullptr) return refuseUnknown("phase", phase, parts.script.names());
    beginPhase(*next, parts);
    return done();
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(phase);
  }
};

}  // namespace cloth_sim
