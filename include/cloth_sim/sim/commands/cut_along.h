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
      const double areaBefore = parts.surgery.dropped().restArea;
      const SurgeryResult result = parts.surgery.cutAlong(stroke, parts.editedCloth());
      if (result.changes.mesh.empty()) return done("the stroke misses the cloth: nothing was cut");
      return done(tell(result, parts.surgery.dropped().restArea - areaBefore,
                       parts.surgery.pieces().count));
    } catch (const OperationRefused& error) {
      return refuse(error.what());
    }
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(stroke);
  }

 private:
  /// "cut 0.25 m, 31 springs severed, 2 pieces"; with the area that was removed [m^2], if any.
  static std::string tell(const SurgeryResult& result, double removed, int pieces) {
    char area[40] = "";
    if (removed > 0.0) std::snprintf(area, sizeof area, ", %.4g m^2 removed", removed);
    char text[160];
    std::snprintf(text, sizeof text, "cut %.4g m, %zu springs severed%s, %d pieces", result.length,
                  result.events.size(), area, pieces);
    return text;
  }
};

}  // namespace cloth_sim
