#pragma once
/// \file The command to cut the cloth.

#include <cstdio>

#include "cloth_sim/sim/command_basics.h"

namespace cloth_sim {

/// Cuts along a stroke of a blade. A stroke that misses the cloth is a success that cuts nothing.
struct CutAlong {
  static constexpr const char* kKind = "cut_along";
  static constexpr Wakes kWakes = Wakes::kAlways;

  Stroke stroke;

  std::string describe() const { return std::to_string(stroke.poses.size()) + " poses"; }
  std::string validationError() const { return cloth_sim::validationError(stroke); }
  CommandResult apply(SimulationParts& parts) const {
    try {
      const SurgeryResult result = parts.surgery.cutAlong(stroke, parts.editedCloth());
      if (result.changes.mesh.empty()) return done("the stroke misses the cloth: nothing was cut");
      return done(tell(result, parts.surgery.pieces().count));
    } catch (const OperationRefused& error) {
      return refuse(error.what());
    }
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(stroke);
  }

 private:
  /// "cut 0.25 m, 31 springs severed, 2 pieces"
  static std::string tell(const SurgeryResult& result, int pieces) {
    const int severed = static_cast<int>(result.events.size()) - result.cleared;
    const std::string cleared =
        result.cleared > 0 ? ", " + std::to_string(result.cleared) + " cleared" : "";
    char text[160];
    std::snprintf(text, sizeof text, "cut %.4g m, %d springs severed%s, %d pieces", result.length,
                  severed, cleared.c_str(), pieces);
    return text;
  }
};

}  // namespace cloth_sim
