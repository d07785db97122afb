#pragma once
/// \file The command to switch tearing on or off.

#include "cloth_sim/sim/command_basics.h"

namespace cloth_sim {

/// Switches tearing, and sets how far springs stretch before they fail.
struct SetTearing {
  static constexpr const char* kKind = "set_tearing";
  static constexpr Wakes kWakes = Wakes::kAlways;

  bool enabled = false;
  TearRatios ratio{};  ///< length over rest length at failure, by kind of spring, > 1

  std::string describe() const { return enabled ? "enabled" : "disabled"; }
  std::string validationError() const {
    for (const double r : ratio) {
      if (!(r > 1.0)) return "tear ratio: expected numbers > 1";
    }
    return "";
  }
  CommandResult apply(SimulationParts& parts) const {
    const Tearing& tearing = parts.surgery.tearing();
    if (tearing.isByEnergy() && ratio != tearing.settings().ratio) {
      return refuse("tear ratio: this scene tears by the energy of its fabric");
    }
    parts.surgery.tearing().setEnabled(enabled);
    parts.surgery.tearing().setRatio(ratio);
    return done();
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(enabled, ratio);
  }
};

}  // namespace cloth_sim
