#pragma once
/// \file The command to change gravity.

#include "cloth_sim/sim/command_basics.h"

namespace cloth_sim {

/// Sets gravity from the next step on.
struct SetGravity {
  static constexpr const char* kKind = "set_gravity";
  static constexpr Wakes kWakes = Wakes::kAlways;

  Vec3 gravity = Vec3::Zero();  ///< in the world [m/s^2]

  std::string describe() const { return toText(gravity); }
  std::string validationError() const {
    return gravity.allFinite() ? "" : "gravity: expected three finite numbers";
  }
  CommandResult apply(SimulationParts& parts) const {
    parts.controls.gravity = gravity;
    return done();
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(gravity);
  }
};

}  // namespace cloth_sim
