#include "cloth_sim/sim/saved_state.h"
#include "cloth_sim/sim/simulation.h"
#include "cloth_sim/surgery/refine.h"
#include "command_checks.h"

namespace cloth_sim {
namespace {

template <typename... Kinds>
bool isOneOf(const Command& command) {
  return (std::holds_alternative<Kinds>(command) || ...);
}

/// Whether all that a command does is to aim clamps and obstacles.
bool onlyAims(const Command& command) {
  return isOneOf<SetClampTarget, GuideClamp, SetGapWidth, SetGrasp, GuideObstacle>(command);
}

}  // namespace

CommandResult Simulation::apply(const Command& command) {
  const CommandResult result = std::visit([this](const auto& it) { return carryOut(it); }, command);
  if (result.success && touches(command)) sleep_.wake();
  return result;
}

/// Whether a command that was carried out ends the rest of the cloth. What is told to be where it
/// is does not; a state that was restored knows itself whether it sleeps.
bool Simulation::touches(const Command& command) const {
  if (std::holds_alternative<Restore>(command)) return false;
  return !onlyAims(command) || !isStill();
}

CommandResult Simulation::carryOut(const SetPhase& command) {
  const PhaseSpec* phase = script_.jump(command.phase, time());
  if (phase == nullptr) {
    return refuse("unknown phase '" + command.phase + "' (" +
                  listNames(script_.names(), [](const std::string& n) { return n; }) + ")");
  }
  beginPhase(*phase);
  return done();
}

CommandResult Simulation::carryOut(const SetGravity& command) {
  if (!command.gravity.allFinite()) return refuse("gravity: expected three finite numbers");
  controls_.gravity = command.gravity;
  return done();
}

CommandResult Simulation::carryOut(const MoveObstacle& command) {
  Collider* collider = colliders_.find(command.obstacle);
  if (collider == nullptr) {
    return refuse("unknown obstacle '" + command.obstacle + "' (" +
                  listNames(colliders_.all(), [](const Collider& c) { return c.obstacle().name; }) +
                  ")");
  }
  const std::string defect = poseDefect(command.pose);
  if (!defect.empty()) return refuse(defect);
  if (!command.velocity.allFinite()) return refuse("velocity: expected three finite numbers");
  guides_.drop(command.obstacle);
  collider->place({command.pose.position, command.pose.orientation.normalized()}, command.velocity,
                  time());
  return done();
}

CommandResult Simulation::carryOut(const GuideObstacle& command) {
  const Collider* collider = colliders_.find(command.obstacle);
  if (collider == nullptr) {
    return refuse("unknown obstacle '" + command.obstacle + "' (" +
                  listNames(colliders_.all(), [](const Collider& c) { return c.obstacle().name; }) +
                  ")");
  }
  const std::string defect = targetDefect(command.target);
  if (!defect.empty()) return refuse(defect);
  MovingPose target = command.target;
  target.pose.orientation.normalize();
  guides_.set(command.obstacle, target);
  return done();
}

CommandResult Simulation::carryOut(const SetTearing& command) {
  for (double ratio : command.ratio) {
    if (!(ratio > 1.0)) return refuse("tear ratio: expected numbers > 1");
  }
  tearing_.setEnabled(command.enabled);
  tearing_.setRatio(command.ratio);
  return done();
}

CommandResult Simulation::carryOut(const CutAlong& command) {
  const std::string defect = validationError(command.stroke);
  if (!defect.empty()) return refuse(defect);
  try {
    const SurgeryResult result = cutStroke(command.stroke);
    if (result.changes.mesh.empty()) return done("the stroke misses the cloth: nothing was cut");
    char text[160];
    const int cleared = result.cleared;
    const int severed = static_cast<int>(result.events.size()) - cleared;
    std::snprintf(text, sizeof text, "cut %.4g m, %d springs severed%s, %d pieces", result.length,
                  severed, cleared > 0 ? (", " + std::to_string(cleared) + " cleared").c_str() : "",
                  pieces());
    return done(text);
  } catch (const TooManyParticles& error) {
    return refuse(error.what());
  }
}

CommandResult Simulation::carryOut(const RefineNear& command) {
  const std::string defect = validationError(command);
  if (!defect.empty()) return refuse(defect);
  try {
    const std::int32_t before = model_.particleCount();
    refineMesh(command);
    return done(std::to_string(model_.particleCount() - before) + " particles added");
  } catch (const TooManyParticles& error) {
    return refuse(error.what());
  }
}

CommandResult Simulation::carryOut(const Reset& command) {
  const double now = time();
  const std::uint64_t steps = stepCount_;
  if (command.scope == ResetScope::kTime) {
    shiftTime(-now);
    stepCount_ = 0;
    return done();
  }
  *this = Simulation(scene_);
  if (command.scope == ResetScope::kState) {
    shiftTime(now);
    stepCount_ = steps;
  }
  return done();
}

CommandResult Simulation::carryOut(const Restore& command) {
  try {
    load(command.bytes);
    return done();
  } catch (const StateError& error) {
    return refuse(error.what());
  }
}

void Simulation::shiftTime(double by) {
  state_.t += by;
  for (Collider& collider : colliders_.all()) collider.shiftTime(by);
  script_.shiftTime(by);
  tearing_.shiftTime(by);
  drag_.shiftTime(by);
}

}  // namespace cloth_sim
