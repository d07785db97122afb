#pragma once
/// \file The command to refine the mesh.

#include "cloth_sim/sim/command_basics.h"
#include "cloth_sim/surgery/refine.h"

namespace cloth_sim {

/// Makes the mesh finer near some points.
struct RefineMesh {
  static constexpr const char* kKind = "refine_near";
  static constexpr Wakes kWakes = Wakes::kAlways;

  RefineNear request;

  std::string describe() const { return std::to_string(request.path.size()) + " points"; }
  std::string validationError() const { return cloth_sim::validationError(request); }
  CommandResult apply(SimulationParts& parts) const {
    try {
      const std::int32_t before = parts.model.particleCount();
      parts.surgery.refine(request, parts.editedCloth());
      return done(std::to_string(parts.model.particleCount() - before) + " particles added");
    } catch (const TooManyParticles& error) {
      return refuse(error.what());
    }
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(request);
  }
};

}  // namespace cloth_sim
