#include "cloth_sim/sim/snapshot.h"

#include <algorithm>

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/sim/simulation.h"
#include "mesh/quality.h"

namespace cloth_sim {
namespace {

ClampSnapshot capture(const Clamp& clamp) {
  ClampSnapshot shot;
  shot.name = clamp.spec().name;
  shot.pose = clamp.pose();
  shot.plateSize = clamp.spec().plateSize;
  shot.gap = clamp.gap();
  shot.state = clamp.state();
  shot.slipping = clamp.isSlipping();
  shot.slipped = clamp.slipped();
  shot.gripForce = clamp.spec().gripForce;
  shot.wrench = clamp.wrench();
  return shot;
}

std::string phaseName(const PhaseScript& script) {
  return script.history().empty() ? "" : script.history().back().name;
}

}  // namespace

std::shared_ptr<const Snapshot> Simulation::snapshot(Detail detail) {
  if (!topology_) topology_ = makeTopology();
  auto shot = std::make_shared<Snapshot>();
  shot->time = time();
  shot->step = stepCount_;
  shot->topology = topology_;
  shot->positions = state_.x.values();
  for (const Clamp& clamp : clamps_) {
    shot->clamps.push_back(capture(clamp));
    shot->clamps.back().contents = gripContents(clamp, model_, state_, colliders_);
  }
  for (const Collider& collider : colliders_.all()) {
    shot->obstacles.push_back(collider.obstacle());
    shot->obstacles.back().pose = collider.poseAt(time());
  }
  shot->phase = phaseName(script_);
  shot->script = script_.status();
  shot->particles = model_.particleCount();
  shot->faces = model_.mesh.faceCount();
  for (int kind = 0; kind < kSpringKinds; ++kind) {
    shot->springs[kind] = model_.springs.count(static_cast<SpringKind>(kind));
  }
  shot->broken = broken_;
  shot->dropped = dropped_;
  shot->tuning = tuning();
  shot->substeps = report_.substeps;
  shot->guard = watch_.record();
  shot->failed = failed();
  shot->failure = failure_;
  if (detail == Detail::kFigures) shot->figures = figures();
  return shot;
}

Figures Simulation::figures() {
  Figures result;
  result.pieces = describePieces();
  result.mass = totalMass(model_);
  result.restArea = model_.mesh.totalRestArea();
  result.energies = energies(model_, state_, controls_.gravity);
  result.meanSpeed = meanSpeed(state_);
  result.maxStretch = observeMaxStretch();
  result.hash = stateHash(model_, state_);
  return result;
}

std::vector<PieceSnapshot> Simulation::describePieces() const {
  std::vector<PieceSnapshot> pieces(static_cast<std::size_t>(pieces_.count));
  for (FaceId f = 0; f < model_.mesh.faceCount(); ++f) {
    PieceSnapshot& piece = pieces[pieces_.ofFace[f]];
    ++piece.faces;
    piece.restArea += model_.mesh.restArea(f);
  }
  for (VertexId v = 0; v < model_.particleCount(); ++v) {
    PieceSnapshot& piece = pieces[pieces_.ofFace[model_.mesh.facesAround(v).front()]];
    piece.mass += model_.mass[v];
    piece.centreOfMass += model_.mass[v] * state_.x[v];
  }
  for (PieceSnapshot& piece : pieces) piece.centreOfMass /= piece.mass;
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const auto& p, const auto& q) { return p.restArea > q.restArea; });
  return pieces;
}

std::shared_ptr<const Topology> Simulation::makeTopology() const {
  auto topology = std::make_shared<Topology>();
  topology->revision = model_.mesh.revision();
  for (const ClothPart& cloth : model_.cloths) {
    topology->cloths.push_back(
        {cloth.name, cloth.firstVertex, cloth.vertices, cloth.materialOffset});
  }
  topology->faces = model_.mesh.faces();
  topology->material = model_.mesh.material();
  for (const Spring& spring : model_.springs.slots()) {
    if (!spring.exists() || spring.kind == SpringKind::kBend) continue;
    topology->links.push_back({spring.a, spring.b, spring.restLength});
  }
  for (FaceId f = 0; f < model_.mesh.faceCount(); ++f) {
    const Face& face = model_.mesh.face(f);
    for (int k = 0; k < 3; ++k) {
      const VertexId a = face[k];
      const VertexId b = face[(k + 1) % 3];
      const bool border = model_.mesh.facesOnEdge(a, b)[1] == kNone;
      if (border && !model_.mesh.isOriginalBoundary(f, k)) topology->tornEdges.push_back({a, b});
    }
  }
  topology->shortestEdge = shortestEdge(model_.mesh);
  topology->stableStep = stableStep(model_);
  return topology;
}

}  // namespace cloth_sim
