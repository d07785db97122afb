#include "cloth_sim/sim/phase_actions.h"

namespace cloth_sim {
namespace {

PhaseObservation observe(const SimulationParts& parts) {
  PhaseObservation now;
  now.time = parts.time();
  if (parts.script.wantsMeanSpeed() && !parts.sleep.isAsleep()) {
    now.meanSpeed = meanSpeed(parts.state);
  }
  now.pieces = parts.surgery.pieces().count;
  now.broken = parts.surgery.failures().counts().total;
  now.inContact = parts.obstacles.areTouched();
  now.clampsAtTarget = parts.holders.areAtTarget();
  now.clampsClosed = parts.holders.haveClosed();
  return now;
}

/// Returns the mean position of a patch's particles.
Vec3 middleOf(const ClampPatch& patch, const Model& model, const State& state) {
  const std::vector<VertexId> particles = patchParticles(model, patch);
  Vec3 middle = Vec3::Zero();
  for (const VertexId v : particles) middle += state.x[v];
  return middle / static_cast<double>(particles.size());
}

/// Returns where a clamp is to go, or nothing if the action leaves its target alone.
std::optional<Pose> targetOf(const ClampAction& action, const Clamp& clamp,
                             const SimulationParts& parts) {
  const bool moves =
      action.hold || action.attach || action.moveBy || action.moveTo || action.orientation;
  if (!moves) return std::nullopt;
  Pose target = action.hold ? clamp.stoppingPose() : clamp.target();
  if (action.attach && clamp.spec().patch) {
    target.position = middleOf(*clamp.spec().patch, parts.model, parts.state);
  }
  if (action.moveBy) target.position += *action.moveBy;
  if (action.moveTo) target.position = *action.moveTo;
  if (action.orientation) target.orientation = *action.orientation;
  return target;
}

void act(const ClampAction& action, SimulationParts& parts) {
  Clamp* clamp = parts.holders.find(action.clamp);
  if (clamp == nullptr) return;
  clamp->setSpeedLimit(action.speed);
  if (action.grasp) *action.grasp ? clamp->close() : clamp->release();
  if (const auto target = targetOf(action, *clamp, parts)) clamp->setTarget(*target);
}

void editMesh(const PhaseSpec& phase, SimulationParts& parts) {
  const EditedCloth cloth = parts.editedCloth();
  try {
    for (const RefineNear& request : phase.refinements) parts.surgery.refine(request, cloth);
    for (const MaterialPath& notch : phase.notches) parts.surgery.cutNotch(notch, cloth);
    for (const Stroke& stroke : phase.strokes) parts.surgery.cutAlong(stroke, cloth);
  } catch (const OperationRefused& error) {
    parts.failure = "phase '" + phase.name + "': " + error.what();
  }
}

}  // namespace

void runScript(SimulationParts& parts) {
  PhaseScript& script = parts.script;
  if (script.status() == ScriptStatus::kIdle && script.history().empty()) {
    if (const PhaseSpec* first = script.start(parts.time())) beginPhase(*first, parts);
    return;
  }
  if (script.status() != ScriptStatus::kRunning) return;
  if (const PhaseSpec* next = script.update(observe(parts))) beginPhase(*next, parts);
  if (script.status() == ScriptStatus::kFailed) parts.failure = script.failureText();
}

void beginPhase(const PhaseSpec& phase, SimulationParts& parts) {
  parts.sleep.wake();
  for (Clamp& clamp : parts.holders.clamps()) clamp.setSpeedLimit(std::nullopt);
  for (const ClampAction& action : phase.clamps) act(action, parts);
  for (const ObstacleAction& action : phase.obstacles) {
    parts.obstacles.setVelocity(action.obstacle, action.velocity, parts.time(),
                                action.angularVelocity);
  }
  if (phase.wind) parts.controls.wind = phase.wind;
  if (phase.tearing) parts.surgery.tearing().setEnabled(*phase.tearing);
  if (phase.ratio) parts.surgery.tearing().setRatio(*phase.ratio);
  if (phase.quasiStatic) parts.controls.quasiStatic = *phase.quasiStatic;
  editMesh(phase, parts);
}

}  // namespace cloth_sim
