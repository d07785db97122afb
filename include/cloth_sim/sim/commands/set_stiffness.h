#pragma once
/// \file The command to change the stiffness of the cloth.

#include "cloth_sim/sim/command_basics.h"

namespace cloth_sim {

/// Makes the cloth stiffer or softer than the scene says, all springs and bending alike.
struct SetStiffness {
  static constexpr const char* kKind = "set_stiffness";
  static constexpr Wakes kWakes = Wakes::kAlways;
  static constexpr double kMaxScale = 1e3;  ///< largest scale, and one over the smallest [-]

  double scale = 1.0;  ///< times the scene's stiffness, 1e-3 ... 1e3 [-]

  std::string describe() const { return "times " + std::to_string(scale); }
  std::string validationError() const {
    const bool inRange = scale >= 1.0 / kMaxScale && scale <= kMaxScale;
    return inRange ? "" : "stiffness: expected a scale of 1e-3 ... 1e3";
  }
  CommandResult apply(SimulationParts& parts) const {
    Model& model = parts.model;
    if (scale == model.springs.scale()) return done();
    ModelChanges changes;
    changes.mesh.fromRevision = changes.mesh.toRevision = model.mesh.revision();
    model.bending.scaleBy(scale / model.springs.scale());
    changes.springs = model.springs.setScale(model.mesh, scale);
    parts.solver.onModelChanged(model, changes);
    return done();
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(scale);
  }
};

}  // namespace cloth_sim
