#pragma once
/// \file The command to change the wind.

#include "cloth_sim/sim/command_basics.h"

namespace cloth_sim {

/// Sets the wind from the next step on, or calms it.
struct SetWind {
  static constexpr const char* kKind = "set_wind";
  static constexpr Wakes kWakes = Wakes::kAlways;

  std::optional<Wind> wind;  ///< absent: none

  std::string describe() const { return wind ? toText(wind->velocity) : "none"; }
  std::string validationError() const {
    if (!wind) return "";
    if (!wind->velocity.allFinite()) return "wind: expected three finite numbers as its velocity";
    if (!isNotNegative(wind->density) || !isNotNegative(wind->dragCoefficient)) {
      return "wind: expected a density and a drag coefficient >= 0";
    }
    return "";
  }
  CommandResult apply(SimulationParts& parts) const {
    parts.controls.wind = wind;
    return done();
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(wind);
  }
};

}  // namespace cloth_sim
