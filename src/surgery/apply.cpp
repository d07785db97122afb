#include "cloth_sim/surgery/apply.h"

#include <algorithm>

#include "cloth_sim/mesh/mesh_editor.h"

namespace cloth_sim {
namespace {

FailureEvent describe(const Model& model, const State& state, const Spring& spring,
                      FailureCause cause, bool overloaded) {
  FailureEvent event;
  event.time = state.t;
  event.a = spring.a;
  event.b = spring.b;
  event.kind = spring.kind;
  event.cause = cause;
  event.stretch = stretch(spring, state);
  event.position = 0.5 * (state.x[spring.a] + state.x[spring.b]);
  event.material = 0.5 * (model.mesh.material(spring.a) + model.mesh.material(spring.b));
  event.overloaded = overloaded;
  return event;
}

/// What of `detach` still holds on to the vertex after earlier openings.
std::vector<FaceId> stillAround(const TriangleMesh& mesh, const Opening& opening) {
  const std::vector<FaceId>& around = mesh.facesAround(opening.vertex);
  std::vector<FaceId> faces;
  for (FaceId f : opening.detach) {
    if (std::binary_search(around.begin(), around.end(), f)) faces.push_back(f);
  }
  return faces;
}

}  // namespace

SurgeryResult openSurface(Model& model, State& state, const std::vector<Opening>& openings,
                          FailureCause cause) {
  SurgeryResult result;
  MeshEditor editor(model.mesh);
  std::vector<std::int32_t> failed;
  const bool overloaded = cause == FailureCause::kTear;
  for (const Opening& opening : openings) {
    // Does nothing if earlier openings have separated these faces already: failed they have.
    editor.splitVertex(opening.vertex, stillAround(model.mesh, opening));
    for (std::int32_t slot : opening.springs) {
      result.events.push_back(describe(model, state, model.springs[slot], cause, overloaded));
      failed.push_back(slot);
    }
  }
  result.changes.mesh = editor.finish();
  if (result.changes.mesh.empty()) return result;

  state.follow(result.changes.mesh);
  shareMass(model.mesh, result.changes.mesh, model.mass);
  result.changes.springs = model.springs.follow(model.mesh, result.changes.mesh);

  const SpringChanges& springs = result.changes.springs;
  std::sort(failed.begin(), failed.end());
  for (std::size_t k = 0; k < springs.removed.size(); ++k) {
    if (std::binary_search(failed.begin(), failed.end(), springs.removed[k])) continue;
    result.events.push_back(describe(model, state, springs.removedSprings[k], cause, false));
  }
  return result;
}

}  // namespace cloth_sim
