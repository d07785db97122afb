#include <algorithm>

#include "cloth_sim/sim/simulation.h"
#include "cloth_sim/surgery/refine.h"

namespace cloth_sim {
namespace {

/// A path in material coordinates as a stroke over the cloth laid flat.
std::vector<SurfacePath> pathsOver(const TriangleMesh& mesh, const MaterialPath& notch) {
  std::vector<Vec3> path;
  for (const Vec2& p : notch) path.push_back(inMaterialPlane(p));
  return findPaths(strokeAlong(path, Vec3::UnitZ(), 1.0), mesh, inMaterialPlane(mesh));
}

const KinematicTarget* findPin(const std::vector<KinematicTarget>& pins, VertexId v) {
  const auto pin = std::lower_bound(
      pins.begin(), pins.end(), v,
      [](const KinematicTarget& target, VertexId vertex) { return target.vertex < vertex; });
  return pin != pins.end() && pin->vertex == v ? &*pin : nullptr;
}

/// Copies of pinned particles stay pinned where they are, and so does what lies between some.
void pinNew(const VertexEdit& edit, std::vector<KinematicTarget>& pins) {
  KinematicTarget blend;
  blend.vertex = edit.id;
  for (std::size_t k = 0; k < edit.from.size() && edit.from[k] != kNone; ++k) {
    const KinematicTarget* source = findPin(pins, edit.from[k]);
    if (source == nullptr) return;
    blend.position += edit.weight[k] * source->position;
  }
  pins.push_back(blend);  // new ids are the largest: the order holds
}

void applyChangesToPins(const MeshChanges& changes, std::vector<KinematicTarget>& pins) {
  for (const VertexEdit& edit : changes.vertices) {
    if (edit.isNew()) pinNew(edit, pins);
    if (edit.kind != VertexEdit::Kind::kRemove) continue;
    for (KinematicTarget& pin : pins) {
      if (pin.vertex == edit.from[0]) pin.vertex = edit.id;
    }
    std::sort(pins.begin(), pins.end(), [](const KinematicTarget& p, const KinematicTarget& q) {
      return p.vertex < q.vertex;
    });
  }
}

}  // namespace

SurgeryResult Simulation::cutStroke(const Stroke& stroke) {
  CutPlan plan;
  plan.paths = findPaths(stroke, model_.mesh, state_.x);
  plan.refine = scene_.surgery.refineCuts;
  if (scene_.surgery.clearStrip) plan.clearWithin = stroke.halfWidth;
  return operate(plan);
}

SurgeryResult Simulation::cutNotch(const MaterialPath& notch) {
  CutPlan plan;
  plan.paths = pathsOver(model_.mesh, notch);
  plan.refine = scene_.surgery.refineCuts;
  return operate(plan);
}

SurgeryResult Simulation::operate(const CutPlan& plan) {
  SurgeryResult result = cut(plan, limits_, heldVertices(), model_, state_);
  // Before anything is renumbered.
  if (plan.cause == FailureCause::kTear) {
    tearing_.noteOpened(result);
  } else {
    tearing_.noteTips(result);
  }
  applyChanges(result);
  return result;
}

void Simulation::refineMesh(const RefineNear& request) {
  applyChanges(refine(request, limits_, heldVertices(), model_, state_));
}

void Simulation::applyChanges(const SurgeryResult& result) {
  if (result.changes.mesh.empty() && result.changes.springs.removed.empty()) return;
  for (const FailureEvent& event : result.events) count(event);
  for (Clamp& clamp : clamps_) clamp.applyChanges(result.changes.mesh);
  drag_.applyChanges(result.changes.mesh);
  applyChangesToPins(result.changes.mesh, pins_);
  solver_->onModelChanged(model_, result.changes);
  tearing_.applyChanges(model_, result.changes);
  pieces_ = connectedComponents(model_.mesh);
  topology_.reset();
  if (scene_.surgery.dropBelow > 0.0 && pieces_.count > 1) dropScraps();
}

void Simulation::dropScraps() {
  std::vector<double> area(static_cast<std::size_t>(pieces_.count), 0.0);
  for (FaceId f = 0; f < model_.mesh.faceCount(); ++f) {
    area[pieces_.ofFace[f]] += model_.mesh.restArea(f);
  }
  // Held pieces are not loose, and the largest one of each cloth is the cloth.
  const std::vector<std::int32_t> largest = largestPieces(area);
  for (VertexId v : heldVertices()) {
    area[pieces_.ofFace[model_.mesh.facesAround(v).front()]] = scene_.surgery.dropBelow;
  }
  for (const std::int32_t piece : largest) area[piece] = scene_.surgery.dropBelow;
  std::vector<FaceId> faces;
  const double massBefore = totalMass(model_);
  const double areaBefore = model_.mesh.totalRestArea();
  for (FaceId f = 0; f < model_.mesh.faceCount(); ++f) {
    if (area[pieces_.ofFace[f]] < scene_.surgery.dropBelow) faces.push_back(f);
  }
  if (faces.empty()) return;
  dropped_.count += static_cast<int>(std::count_if(
      area.begin(), area.end(), [this](double a) { return a < scene_.surgery.dropBelow; }));
  applyChanges(removeComponents(faces, model_, state_));
  dropped_.mass += massBefore - totalMass(model_);
  dropped_.restArea += areaBefore - model_.mesh.totalRestArea();
}

/// By cloth; of equal ones the first.
std::vector<std::int32_t> Simulation::largestPieces(const std::vector<double>& area) const {
  std::vector<std::int32_t> largest(model_.cloths.size(), kNone);
  for (FaceId f = 0; f < model_.mesh.faceCount(); ++f) {
    const std::int32_t piece = pieces_.ofFace[f];
    std::int32_t& best = largest[model_.clothOf(model_.mesh.face(f)[0])];
    if (best == kNone || area[piece] > area[best]) best = piece;
  }
  return largest;
}

std::vector<VertexId> Simulation::heldVertices() const {
  std::vector<VertexId> held;
  for (const KinematicTarget& pin : pins_) held.push_back(pin.vertex);
  for (const Clamp& clamp : clamps_) {
    held.insert(held.end(), clamp.held().begin(), clamp.held().end());
  }
  if (drag_.vertex() != kNone) held.push_back(drag_.vertex());
  std::sort(held.begin(), held.end());
  held.erase(std::unique(held.begin(), held.end()), held.end());
  return held;
}

}  // namespace cloth_sim
