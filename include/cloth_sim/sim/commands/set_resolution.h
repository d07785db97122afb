#pragma once
/// \file The command to begin anew with another number of particles.

#include "cloth_sim/scene/resolution.h"
#include "cloth_sim/sim/command_basics.h"

namespace cloth_sim {

/// Goes back to the start of the scene and of time, with other numbers of particles
/// (`withColumns`).
struct SetResolution {
  static constexpr const char* kKind = "set_resolution";
  static constexpr Wakes kWakes = Wakes::kAlways;

  std::int32_t columns = 0;  ///< of the first cloth; 0: as in the scene

  std::string describe() const { return std::to_string(columns) + " columns"; }
  /// Empty: `withColumns` checks the number, which depends on the scene.
  std::string validationError() const { return ""; }
  CommandResult apply(SimulationParts& parts) const {
    try {
      parts = SimulationParts(withColumns(parts.scene, columns));
      return done("begins anew with " + gridsText(parts.scene) + " particles");
    } catch (const std::invalid_argument& error) {
      return refuse(error.what());
    }
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(columns);
  }
};

}  // namespace cloth_sim
