#pragma once
/// \file Whole operations on a cloth: cut it, refine it, take loose pieces away.

#include <stdexcept>

#include "cloth_sim/surgery/failure.h"
#include "cloth_sim/surgery/path_embedder.h"
#include "cloth_sim/surgery/settings.h"

namespace cloth_sim {

/// What holds for every operation on a cloth.
struct SurgeryLimits {
  ShapeLimits shape;
  std::int32_t maxParticles = 1 << 20;
};

/// Where to cut.
struct CutPlan {
  std::vector<SurfacePath> paths;
  PathEnd end = PathEnd::kExact;
  FailureCause cause = FailureCause::kCut;
  std::vector<std::int32_t> overloaded;  ///< slots of springs that passed their limits, ascending
  std::optional<Refinement> refine;      ///< along the paths, before they are cut
  double clearWithin = 0.0;              ///< clear springs whose middle is this near [m]
};

struct SurgeryResult {
  ModelChanges changes;              ///< empty if nothing was done
  std::vector<FailureEvent> events;  ///< each failed spring once
  double length = 0.0;               ///< of all cuts, at rest [m]
  double deviation = 0.0;            ///< farthest that a cut was bent away from its path [m]
  int cleared = 0;                   ///< springs cleared within CutPlan::clearWithin
  std::vector<VertexId> tips;        ///< vertices at which cuts end
};

/// The cloth would have more particles than it may.
class TooManyParticles : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Cuts a cloth along paths over its surface. Mass, rest area, linear and angular momentum stay
/// what they were; no face is lost.
/// \param held  particles that somebody holds in place, ascending.
/// \throws TooManyParticles, and nothing has changed.
SurgeryResult cut(const CutPlan& plan, const SurgeryLimits& limits,
                  const std::vector<VertexId>& held, Model& model, State& state);

/// Refines a cloth where it is near some points in the world; keeps what `cut` keeps.
/// \throws TooManyParticles, and nothing has changed.
SurgeryResult refine(const RefineNear& request, const SurgeryLimits& limits,
                     const std::vector<VertexId>& held, Model& model, State& state);

/// Takes whole pieces away.
/// \param faces  all faces of the pieces, ascending.
SurgeryResult removeComponents(const std::vector<FaceId>& faces, Model& model, State& state);

}  // namespace cloth_sim
