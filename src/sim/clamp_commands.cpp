/// \file Commands to clamps.

#include <algorithm>
#include <stdexcept>

#include "cloth_sim/sim/simulation.h"
#include "command_checks.h"

namespace cloth_sim {
namespace {

std::string nameOf(const Clamp& clamp) { return clamp.spec().name; }

CommandResult unknownClamp(const std::string& name, const std::vector<Clamp>& clamps) {
  return refuse("unknown clamp '" + name + "' (" + listNames(clamps, nameOf) + ")");
}

}  // namespace

Clamp* Simulation::findClamp(const std::string& name) {
  for (Clamp& clamp : clamps_) {
    if (clamp.spec().name == name) return &clamp;
  }
  return nullptr;
}

CommandResult Simulation::carryOut(const SetClampTarget& command) {
  Clamp* clamp = findClamp(command.clamp);
  if (clamp == nullptr) return unknownClamp(command.clamp, clamps_);
  const std::string defect = poseDefect(command.pose);
  if (!defect.empty()) return refuse(defect);
  clamp->setTarget({command.pose.position, command.pose.orientation.normalized()});
  return done();
}

CommandResult Simulation::carryOut(const GuideClamp& command) {
  Clamp* clamp = findClamp(command.clamp);
  if (clamp == nullptr) return unknownClamp(command.clamp, clamps_);
  const std::string defect = targetDefect(command.target);
  if (!defect.empty()) return refuse(defect);
  MovingPose target = command.target;
  target.pose.orientation.normalize();
  clamp->guide(target);
  return done();
}

CommandResult Simulation::carryOut(const SetGripForce& command) {
  Clamp* clamp = findClamp(command.clamp);
  if (clamp == nullptr) return unknownClamp(command.clamp, clamps_);
  if (command.force && !(std::isfinite(*command.force) && *command.force > 0.0)) {
    return refuse("grip force: expected a finite number > 0");
  }
  clamp->setGripForce(command.force);
  return done();
}

CommandResult Simulation::carryOut(const SetGapWidth& command) {
  Clamp* clamp = findClamp(command.clamp);
  if (clamp == nullptr) return unknownClamp(command.clamp, clamps_);
  if (!std::isfinite(command.width)) return refuse("width: expected a finite number");
  const bool closes = command.width <= 0.5 * (clamp->spec().gapClosed + clamp->spec().gapOpen);
  closes ? clamp->close() : clamp->release();
  return done();
}

CommandResult Simulation::carryOut(const CreateClamp& command) {
  if (findClamp(command.spec.name) != nullptr) {
    return refuse("there is a clamp '" + command.spec.name + "' already");
  }
  try {
    if (command.spec.patch) patchParticles(model_, *command.spec.patch);
    clamps_.emplace_back(command.spec);
  } catch (const std::invalid_argument& error) {
    return refuse(error.what());
  }
  return done();
}

CommandResult Simulation::carryOut(const DeleteClamp& command) {
  const auto named = [&](const Clamp& clamp) { return nameOf(clamp) == command.clamp; };
  const auto found = std::find_if(clamps_.begin(), clamps_.end(), named);
  if (found == clamps_.end()) return unknownClamp(command.clamp, clamps_);
  clamps_.erase(found);
  grips_.forget(command.clamp);
  return done();
}

CommandResult Simulation::carryOut(const SetGrasp& command) {
  Clamp* clamp = findClamp(command.clamp);
  if (clamp == nullptr) return unknownClamp(command.clamp, clamps_);
  command.grasp ? clamp->close() : clamp->release();
  return done();
}

}  // namespace cloth_sim
