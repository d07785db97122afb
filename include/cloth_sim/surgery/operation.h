#pragma once
/// \file Operations on model and state: cut, refine, cut out faces, remove connected components.

#include <stdexcept>

#include "cloth_sim/surgery/failure.h"
#include "cloth_sim/surgery/material_path.h"
#include "cloth_sim/surgery/path_embedder.h"
#include "cloth_sim/surgery/settings.h"

namespace cloth_sim {

/// Limits of every operation.
struct SurgeryLimits {
  ShapeLimits shape;
  std::int32_t maxParticles = 1 << 20;
};

/// A cut: its paths, and how they are made.
struct CutPlan {
  std::vector<SurfacePath> paths;
  PathEnd end = PathEnd::kExact;
  FailureCause cause = FailureCause::kCut;
  std::vector<std::int32_t> overloaded;  ///< slots of springs beyond their limits, ascending
  std::optional<Refinement> refine;      ///< refinement along the paths, before they are cut
  /// Half-width of the strip along the paths that is to be removed after the cut [m]; 0: none.
  double stripHalfWidth = 0.0;
};

/// The effects of an operation.
struct SurgeryResult {
  ModelChanges changes;              ///< empty if nothing changed
  std::vector<FailureEvent> events;  ///< one for each failed spring
  double length = 0.0;               ///< of all cuts, at rest [m]
  double deviation = 0.0;            ///< largest distance of a cut from its path, at rest [m]
  std::vector<MaterialPath> lines;   ///< the cuts along mesh edges, at rest [m]
  std::vector<VertexId> tips;        ///< first and last vertex of each path, in their order
};

/// Thrown if an operation is not carried out; the text is one sentence.
class OperationRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Thrown if an operation would exceed SurgeryLimits::maxParticles.
class TooManyParticles : public OperationRefused {
 public:
  using OperationRefused::OperationRefused;
};

/// Thrown if layers of cloth lie too close on each other for the lips of a cut to part.
class LayersInTheWay : public OperationRefused {
 public:
  using OperationRefused::OperationRefused;
};

/// Cuts cloth along paths over its surface. Conserves mass, rest area, and linear and angular
/// momentum up to rounding.
/// \param held  particles that must not be moved, ascending.
/// \throws TooManyParticles without changing anything; OperationRefused likewise, if nothing of a
///         cloth would be left beside the strip.
SurgeryResult cut(const CutPlan& plan, const SurgeryLimits& limits,
                  const std::vector<VertexId>& held, Model& model, State& state);

/// Refines cloth near a path in the world. Conserves what `cut` conserves.
/// \throws TooManyParticles without changing anything.
SurgeryResult refine(const RefineNear& request, const SurgeryLimits& limits,
                     const std::vector<VertexId>& held, Model& model, State& state);

/// Returns the faces of the strip along a cut, ascending: those with their centre within
/// `halfWidth` of a line at rest [m], and no corner that is held.
/// \param held  particles, ascending.
std::vector<FaceId> facesOfStrip(const std::vector<MaterialPath>& lines, double halfWidth,
                                 const std::vector<VertexId>& held, const TriangleMesh& mesh);

/// Detaches faces from the cloth around them, so that they are connected components of their own,
/// which `removeComponents` can remove. Reports their springs as cut, and those that joined them to
/// the rest; the rest keeps the springs along its new border. Conserves what `cut` conserves.
/// \param faces  ascending.
SurgeryResult cutOut(const std::vector<FaceId>& faces, Model& model, State& state);

/// Removes connected components.
/// \param faces  all of their faces, ascending.
SurgeryResult removeComponents(const std::vector<FaceId>& faces, Model& model, State& state);

}  // namespace cloth_sim
