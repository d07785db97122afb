#pragma once
/// \file The command that declares motion to be quasi-static, or no longer.

#include "cloth_sim/sim/command_basics.h"

namespace cloth_sim {

/// Declares that accelerations are negligible from now on, so that a method may add inertia where
/// that makes its forces more accurate (`line_xpbd` does).
struct SetQuasiStatic {
  static constexpr const char* kKind = "set_quasi_static";
  static constexpr Wakes kWakes = Wakes::kAlways;

  bool enabled = false;

  std::string describe() const { return enabled ? "on" : "off"; }
  std::string validationError() const { return ""; }
  CommandResult apply(SimulationParts& parts) const {
    parts.controls.quasiStatic = enabled;
    return done();
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(enabled);
  }
};

}  // namespace cloth_sim
