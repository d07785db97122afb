#include <algorithm>

#include "snapshot_parts.h"

namespace cloth_sim {
namespace {

ClampSnapshot capture(const Clamp& clamp, const SimulationParts& parts) {
  ClampSnapshot shot;
  shot.name = clamp.spec().name;
  shot.pose = clamp.pose();
  shot.plateSize = clamp.spec().plateSize;
  shot.gap = clamp.gap();
  shot.state = clamp.state();
  shot.contents = gripContents(clamp, parts.model, parts.state, parts.obstacles.colliders());
  shot.slipping = clamp.isSlipping();
  shot.blocked = isBlocked(clamp, parts.layers.get());
  shot.slipped = clamp.slipped();
  shot.gripForce = clamp.spec().gripForce;
  shot.wrench = clamp.wrench();
  return shot;
}

std::string phaseName(const PhaseScript& script) {
  return script.history().empty() ? "" : script.history().back().name;
}

Figures figuresOf(SimulationParts& parts) {
  Figures result;
  result.pieces = describePieces(parts.model, parts.state, parts.surgery.pieces());
  result.mass = totalMass(parts.model);
  result.restArea = parts.model.mesh.totalRestArea();
  result.energies = energies(parts.model, parts.state, parts.controls.gravity);
  result.meanSpeed = meanSpeed(parts.state);
  result.maxStretch =
      parts.measurements.measureMaxStretch(parts.model, parts.state, parts.sleep.isAsleep());
  result.hash = stateHash(parts.model, parts.state);
  return result;
}

/// Fills in everything that describes the cloth.
void showCloth(const SimulationParts& parts, Snapshot& shot) {
  shot.positions = parts.state.x.values();
  shot.particles = parts.model.particleCount();
  shot.faces = parts.model.mesh.faceCount();
  for (int kind = 0; kind < kSpringKinds; ++kind) {
    shot.springs[kind] = parts.model.springs.count(static_cast<SpringKind>(kind));
  }
  shot.broken = parts.surgery.failures().counts();
  shot.dropped = parts.surgery.dropped();
}

/// Fills in everything that acts on the cloth.
void showSurroundings(const SimulationParts& parts, Snapshot& shot) {
  for (const Clamp& clamp : parts.holders.clamps()) shot.clamps.push_back(capture(clamp, parts));
  for (const Collider& collider : parts.obstacles.colliders().all()) {
    shot.obstacles.push_back(collider.obstacle());
    shot.obstacles.back().pose = collider.poseAt(parts.time());
  }
  shot.obstacleWrenches = parts.obstacles.wrenches(parts.time());
  shot.phase = phaseName(parts.script);
  shot.phaseProgress = parts.script.progressText();
  shot.script = parts.script.status();
  shot.tuning = parts.tuning();
}

}  // namespace

std::shared_ptr<const Snapshot> takeSnapshot(SimulationParts& parts, Detail detail,
                                             ContactDetail contacts) {
  auto shot = std::make_shared<Snapshot>();
  shot->time = parts.time();
  shot->step = parts.stepCount;
  shot->topology = parts.measurements.topology(parts.model, parts.surgery.edits());
  showCloth(parts, *shot);
  showSurroundings(parts, *shot);
  shot->substeps = parts.solver.report().substeps;
  shot->error = parts.solver.report().error;
  if (parts.layers) shot->layers = parts.layers->report();
  if (parts.layers && contacts == ContactDetail::kPoints) {
    shot->contactPoints = parts.layers->contactPoints();
  }
  shot->guard = parts.solver.guard();
  shot->failed = parts.failed();
  shot->failure = parts.failure;
  shot->warnings = parts.warnings();
  if (detail == Detail::kFigures) shot->figures = figuresOf(parts);
  return shot;
}

std::vector<PieceSnapshot> describePieces(const Model& model, const State& state,
                                          const ConnectedComponents& pieces) {
  std::vector<PieceSnapshot> list(static_cast<std::size_t>(pieces.count));
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
    PieceSnapshot& piece = list[pieces.ofFace[f]];
    ++piece.faces;
    piece.restArea += model.mesh.restArea(f);
  }
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    PieceSnapshot& piece = list[pieces.ofFace[model.mesh.facesAround(v).front()]];
    piece.mass += model.mass[v];
    piece.centreOfMass += model.mass[v] * state.x[v];
  }
  for (PieceSnapshot& piece : list) piece.centreOfMass /= piece.mass;
  std::stable_sort(list.begin(), list.end(),
                   [](const auto& p, const auto& q) { return p.restArea > q.restArea; });
  return list;
}

}  // namespace cloth_sim
