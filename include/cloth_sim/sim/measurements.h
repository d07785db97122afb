#pragma once
/// \file Quantities that are measured only when somebody asks, and remembered where that saves
/// work.

#include <memory>
#include <optional>

#include "cloth_sim/sim/snapshot.h"

namespace cloth_sim {

/// Largest stretch and topology of a simulation, for snapshots and summaries.
class Measurements {
 public:
  /// Returns the largest stretch (length over rest length [-]) of all structural and shear springs.
  /// \param isAsleep  whether the cloth has not moved since the last call after `fellAsleep`.
  double measureMaxStretch(const Model& model, const State& state, bool isAsleep);
  /// Returns the largest value that `measureMaxStretch` has returned; 1 if none was larger.
  double maxStretchSeen() const { return maxStretchSeen_; }
  /// Forgets the stretch from before the cloth came to rest.
  void fellAsleep() { stretchAsleep_.reset(); }

  /// Returns the topology of the model; the same object until the mesh or the springs change.
  /// \param edits  number of edits of the model so far.
  std::shared_ptr<const Topology> topology(const Model& model, std::uint64_t edits);

 private:
  friend class StateFormat;

  double maxStretchSeen_ = 1.0;
  std::optional<double> stretchAsleep_;  ///< the last stretch measured
  std::shared_ptr<const Topology> topology_;
  std::uint64_t topologyEdits_ = 0;  ///< number of edits when topology_ was made
  double topologyScale_ = 0.0;       ///< stiffness scale when topology_ was made [-]
};

}  // namespace cloth_sim
