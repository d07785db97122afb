#include "cloth_sim/surgery/operation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_map>

#include "cloth_sim/surgery/refine.h"
#include "momentum.h"

namespace cloth_sim {
namespace {

/// Upper bound on the vertices that embedding a path creates per point of the path.
constexpr double kVerticesPerPoint = 8.0;
/// No limit on the number of vertices.
constexpr std::int32_t kAnyNumber = std::numeric_limits<std::int32_t>::max();

/// Brings model and state up to date after an edit of the mesh, and keeps the momentum of the
/// vertices that it touched.
SpringChanges applyChanges(const MeshChanges& changes, Model& model, State& state) {
  const Momentum before = momentumOf(changes.touched, model.mass, state);
  state.applyChanges(changes, model.mesh);
  SpringChanges springs = model.applyChanges(changes);
  restoreMomentum(before, changes.touched, model.mass, state);
  return springs;
}

template <typename T>
void append(const std::vector<T>& more, std::vector<T>& all) {
  all.insert(all.end(), more.begin(), more.end());
}

bool contains(const std::vector<std::int32_t>& ascending, std::int32_t slot) {
  return std::binary_search(ascending.begin(), ascending.end(), slot);
}

std::vector<Vec3> pointsOf(const SurfacePath& path) {
  std::vector<Vec3> points;
  for (const SurfacePoint& p : path.points) points.push_back(inMaterialPlane(p.material));
  return points;
}

/// Refines the mesh along the paths of a plan if it asks for that.
void refineAlong(const CutPlan& plan, std::int32_t maxVertices, Remesher& remesher) {
  if (!plan.refine) return;
  for (const SurfacePath& path : plan.paths) {
    const Neighbourhood near(pointsOf(path), plan.refine->radius);
    std::vector<FaceId> seeds;
    for (const SurfacePoint& p : path.points) seeds.push_back(locate(remesher.mesh(), p));
    refineNear(near, *plan.refine, inMaterialPlane(remesher.mesh()), seeds, maxVertices, remesher);
  }
}

/// Edits the mesh so that the paths of a plan run along marked edges.
std::vector<EmbeddedPath> embedPaths(const CutPlan& plan, std::int32_t maxVertices,
                                     Remesher& remesher) {
  refineAlong(plan, maxVertices, remesher);
  std::vector<EmbeddedPath> embedded;
  for (const SurfacePath& path : plan.paths) {
    embedded.push_back(embedPath(path, plan.end, remesher));
  }
  remesher.improveAngles();
  return embedded;
}

[[noreturn]] void refuse(std::int32_t wanted, std::int32_t allowed) {
  throw TooManyParticles(
      "this would make " + std::to_string(wanted) +
      " particles or more, and cloth.surgery.max_particles = " + std::to_string(allowed));
}

/// Returns a generous upper bound on the number of vertices that a plan creates.
double vertexBound(const CutPlan& plan, const TriangleMesh& mesh) {
  double points = 0.0;
  double area = 0.0;
  for (const SurfacePath& path : plan.paths) {
    points += static_cast<double>(path.points.size());
    if (!plan.refine) continue;
    const double r = plan.refine->radius;
    for (std::size_t k = 0; k + 1 < path.points.size(); ++k) {
      area += 4.0 * r * (path.points[k + 1].material - path.points[k].material).norm();
    }
    area += 8.0 * r * r;
  }
  const double refined = plan.refine ? std::exp2(plan.refine->generations) : 1.0;
  const double facesPerArea = mesh.faceCount() / mesh.totalRestArea();
  return refined * (kVerticesPerPoint * points + 4.0 * facesPerArea * area);
}

/// Throws TooManyParticles if a plan creates too many particles. Where the bound does not rule that
/// out, it tries the plan on a copy of the mesh.
void checkCount(const CutPlan& plan, const SurgeryLimits& limits, const TriangleMesh& mesh) {
  const std::int32_t most = limits.maxParticles;
  if (mesh.vertexCount() + vertexBound(plan, mesh) <= most) return;
  TriangleMesh trial = mesh;
  Remesher remesher(trial, limits.shape, {});
  embedPaths(plan, most, remesher);
  const auto opened = static_cast<std::int32_t>(2 * remesher.marks().size());
  if (trial.vertexCount() + opened > most) refuse(trial.vertexCount() + opened, most);
}

MaterialPath materialOf(const EmbeddedPath& path, const TriangleMesh& mesh) {
  MaterialPath points;
  for (VertexId v : path.vertices) points.push_back(mesh.material(v));
  return points;
}

/// Material coordinates of vertices before an edit of the mesh.
class MaterialBefore {
 public:
  MaterialBefore(const TriangleMesh& mesh, const MeshChanges& changes) : mesh_(mesh) {
    for (const auto& [v, from] : changes.movedFrom)
      from_.emplace(v, from);  // only the first one is stored
  }
  const Vec2& operator[](VertexId v) const {
    const auto found = from_.find(v);
    return found == from_.end() ? mesh_.material(v) : found->second;
  }

 private:
  const TriangleMesh& mesh_;
  std::unordered_map<VertexId, Vec2> from_;
};

/// Throws OperationRefused if nothing of a cloth would be left beside the strip of a plan. It tries
/// the plan on a copy of the mesh.
void checkStrip(const CutPlan& plan, const ShapeLimits& shape, const std::vector<VertexId>& held,
                const Model& model) {
  TriangleMesh trial = model.mesh;
  Remesher remesher(trial, shape, held);
  std::vector<MaterialPath> lines;
  for (const EmbeddedPath& path : embedPaths(plan, kAnyNumber, remesher)) {
    lines.push_back(materialOf(path, trial));
  }
  const std::vector<FaceId> strip = facesOfStrip(lines, plan.stripHalfWidth, held, trial);
  std::vector<bool> isLeft(model.cloths.size(), false);
  for (FaceId f = 0; f < trial.faceCount(); ++f) {
    if (!contains(strip, f)) isLeft[model.strips.at(trial.material(trial.face(f)[0]))] = true;
  }
  const auto gone = std::find(isLeft.begin(), isLeft.end(), false);
  if (gone == isLeft.end()) return;
  throw OperationRefused("the half_width of the stroke is too large: nothing of cloth '" +
                         model.cloths[static_cast<std::size_t>(gone - isLeft.begin())].name +
                         "' would be left");
}

/// Detaches faces from those around them, which keep the numbers of the vertices between both.
void detach(const std::vector<FaceId>& faces, MeshEditor& editor) {
  const TriangleMesh& mesh = editor.mesh();
  for (const FaceId f : faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = mesh.face(f)[k];
      std::vector<FaceId> there;
      for (const FaceId around : mesh.facesAround(v)) {
        if (contains(faces, around)) there.push_back(around);
      }
      editor.splitVertex(v, there);
    }
  }
}

/// Returns the slots of the springs that stand on faces, ascending.
std::vector<std::int32_t> springsOnFaces(const std::vector<FaceId>& faces, const Model& model) {
  std::vector<VertexId> corners;
  for (const FaceId f : faces) {
    const Face& face = model.mesh.face(f);
    corners.insert(corners.end(), face.begin(), face.end());
  }
  return model.springs.springsOnAny(corners);
}

/// Identifies a spring by its kind and by where its ends are at rest [m].
using RestKey = std::array<double, 5>;

RestKey restKeyOf(const Spring& spring, const TriangleMesh& mesh) {
  std::array<double, 2> a{mesh.material(spring.a).x(), mesh.material(spring.a).y()};
  std::array<double, 2> b{mesh.material(spring.b).x(), mesh.material(spring.b).y()};
  if (b < a) std::swap(a, b);
  return {static_cast<double>(spring.kind), a[0], a[1], b[0], b[1]};
}

/// A cut in progress: embeds the paths as mesh edges, opens the mesh along them, and updates model
/// and state.
class CutOperation {
 public:
  CutOperation(const CutPlan& plan, Model& model, State& state)
      : plan_(plan), model_(model), state_(state) {}

  SurgeryResult run(const ShapeLimits& shape, const std::vector<VertexId>& held) {
    Remesher remesher(model_.mesh, shape, held);
    noteEmbedded(embedPaths(plan_, kAnyNumber, remesher));
    remesher.openMarkedEdges();
    result_.changes.mesh = remesher.finish();
    if (!result_.changes.mesh.empty()) {
      reportSevered();
      result_.changes.springs = applyChanges(result_.changes.mesh, model_, state_);
    }
    return std::move(result_);
  }

 private:
  void noteEmbedded(const std::vector<EmbeddedPath>& embedded) {
    for (const EmbeddedPath& path : embedded) {
      result_.lines.push_back(materialOf(path, model_.mesh));
      result_.length += path.length;
      result_.deviation = std::max(result_.deviation, path.deviation);
      append({path.vertices.front(), path.vertices.back()}, result_.tips);
    }
  }

  /// Reports the springs that the cut crosses as failed, by the positions of their ends before the
  /// edit: a spring has failed also if one of its ends then moved onto the cut and it continues as
  /// a shorter one. Springs that refinement replaces have not failed. Call this before springs and
  /// state are updated.
  void reportSevered() {
    const MaterialBefore before(model_.mesh, result_.changes.mesh);
    const std::vector<PathIndex> lines(result_.lines.begin(), result_.lines.end());
    for (std::int32_t slot : model_.springs.springsOnAny(result_.changes.mesh.touched)) {
      const Spring& spring = model_.springs[slot];
      const Vec2& a = before[spring.a];
      const Vec2& b = before[spring.b];
      const bool severed = std::any_of(lines.begin(), lines.end(),
                                       [&](const PathIndex& line) { return line.separates(a, b); });
      if (!severed) continue;
      FailureEvent event = describeFailure(model_, state_, spring, plan_.cause);
      event.overloaded = contains(plan_.overloaded, slot);
      event.material = 0.5 * (a + b);
      result_.events.push_back(event);
    }
  }

  const CutPlan& plan_;
  Model& model_;
  State& state_;
  SurgeryResult result_;
};

}  // namespace

SurgeryResult cut(const CutPlan& plan, const SurgeryLimits& limits,
                  const std::vector<VertexId>& held, Model& model, State& state) {
  if (plan.paths.empty()) return {};
  checkCount(plan, limits, model.mesh);
  if (plan.stripHalfWidth > 0.0) checkStrip(plan, limits.shape, held, model);
  return CutOperation(plan, model, state).run(limits.shape, held);
}

SurgeryResult refine(const RefineNear& request, const SurgeryLimits& limits,
                     const std::vector<VertexId>& held, Model& model, State& state) {
  const Neighbourhood near(request.path, request.refinement.radius);
  std::vector<FaceId> seeds;
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
    const Face& face = model.mesh.face(f);
    if (near.reaches({state.x[face[0]], state.x[face[1]], state.x[face[2]]})) seeds.push_back(f);
  }
  SurgeryResult result;
  if (seeds.empty()) return result;
  TriangleMesh trial = model.mesh;
  Remesher remesher(trial, limits.shape, held);
  refineNear(near, request.refinement, state.x, seeds, limits.maxParticles, remesher);
  const MeshChanges changes = remesher.finish();
  if (trial.vertexCount() > limits.maxParticles) refuse(trial.vertexCount(), limits.maxParticles);
  if (changes.empty()) return result;
  model.mesh = std::move(trial);
  result.changes.mesh = changes;
  result.changes.springs = applyChanges(changes, model, state);
  return result;
}

std::vector<FaceId> facesOfStrip(const std::vector<MaterialPath>& lines, double halfWidth,
                                 const std::vector<VertexId>& held, const TriangleMesh& mesh) {
  std::vector<FaceId> faces;
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    const Face& face = mesh.face(f);
    const Vec2 centre =
        (mesh.material(face[0]) + mesh.material(face[1]) + mesh.material(face[2])) / 3.0;
    const bool isNear = std::any_of(lines.begin(), lines.end(), [&](const MaterialPath& line) {
      return distanceTo(line, centre) <= halfWidth;
    });
    const auto isHeld = [&](VertexId v) { return contains(held, v); };
    if (isNear && std::none_of(face.begin(), face.end(), isHeld)) faces.push_back(f);
  }
  return faces;
}

SurgeryResult cutOut(const std::vector<FaceId>& faces, Model& model, State& state) {
  const std::vector<std::int32_t> slots = springsOnFaces(faces, model);
  std::vector<Spring> springs;
  for (const std::int32_t slot : slots) springs.push_back(model.springs[slot]);
  SurgeryResult result;
  MeshEditor editor(model.mesh);
  detach(faces, editor);
  result.changes.mesh = editor.finish();
  if (!result.changes.mesh.empty()) {
    result.changes.springs = applyChanges(result.changes.mesh, model, state);
  }
  const SpringChanges& changes = result.changes.springs;
  const std::vector<std::int32_t> gone = springsOnFaces(faces, model);
  std::set<RestKey> kept;  // along the new border of the rest, in other slots
  for (const std::int32_t slot : changes.added) {
    if (!contains(gone, slot)) kept.insert(restKeyOf(model.springs[slot], model.mesh));
  }
  for (std::size_t k = 0; k < slots.size(); ++k) {
    const bool isGone = contains(gone, slots[k]) || contains(changes.removed, slots[k]);
    if (!isGone || kept.count(restKeyOf(springs[k], model.mesh)) != 0) continue;
    result.events.push_back(describeFailure(model, state, springs[k], FailureCause::kCut));
  }
  return result;
}

SurgeryResult removeComponents(const std::vector<FaceId>& faces, Model& model, State& state) {
  SurgeryResult result;
  MeshEditor editor(model.mesh);
  editor.removeComponents(faces);
  result.changes.mesh = editor.finish();
  if (!result.changes.mesh.empty()) {
    result.changes.springs = applyChanges(result.changes.mesh, model, state);
  }
  return result;
}

}  // namespace cloth_sim
