#pragma once
/// \file Commands that begin anew: reset, and go on from a saved state.

#include "cloth_sim/sim/command_basics.h"
#include "cloth_sim/sim/saved_state.h"

namespace cloth_sim {

enum class ResetScope : std::uint8_t {
  kBoth,   ///< back to the start of the scene, and of time
  kState,  ///< back to the start of the scene, while time and steps go on
  kTime,   ///< time and steps begin at zero again; cloth, clamps and phases stay as they are
};

/// Goes back to the start of the scene, of time, or of both.
struct Reset {
  static constexpr const char* kKind = "reset";
  static constexpr Wakes kWakes = Wakes::kAlways;

  ResetScope scope = ResetScope::kBoth;

  std::string describe() const {
    switch (scope) {
      case ResetScope::kBoth:
        return "state and time";
      case ResetScope::kState:
        return "state";
      case ResetScope::kTime:
        return "time";
    }
    return "";
  }
  std::string validationError() const { return ""; }
  CommandResult apply(SimulationParts& parts) const {
    const double now = parts.time();
    const std::uint64_t steps = parts.stepCount;
    if (scope != ResetScope::kTime) parts = SimulationParts(Scene(parts.scene));
    if (scope == ResetScope::kState) parts.shiftTime(now);
    if (scope == ResetScope::kTime) parts.shiftTime(-now);
    parts.stepCount = scope == ResetScope::kState ? steps : 0;
    return done();
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(scope);
  }
};

/// Goes on from a saved state (Simulation::save).
struct Restore {
  static constexpr const char* kKind = "restore";
  static constexpr Wakes kWakes = Wakes::kNever;  // the state says whether it sleeps

  std::string bytes;

  std::string describe() const { return std::to_string(bytes.size()) + " bytes"; }
  /// Empty: `loadParts` checks the bytes while it reads them.
  std::string validationError() const { return ""; }
  CommandResult apply(SimulationParts& parts) const {
    try {
      parts = loadParts(bytes, parts);
      return done();
    } catch (const StateError& error) {
      return refuse(error.what());
    }
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(bytes);
  }
};

}  // namespace cloth_sim
