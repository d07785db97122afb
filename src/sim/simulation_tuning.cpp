#include <cmath>

#include "cloth_sim/sim/simulation.h"
#include "command_checks.h"

namespace cloth_sim {
namespace {

/// Times the scene's stiffness that can be asked for at most, and one over the least [-].
constexpr double kMostScale = 1e3;

bool isNotNegative(double value) { return std::isfinite(value) && value >= 0.0; }

}  // namespace

Tuning Simulation::tuning() const {
  Tuning now;
  now.gravity = controls_.gravity;
  now.wind = controls_.wind;
  now.tearing = tearing_.settings().enabled;
  now.ratio = tearing_.settings().ratio;
  now.stiffness = model_.springs.scale();
  return now;
}

CommandResult Simulation::carryOut(const SetWind& command) {
  if (command.wind) {
    if (!command.wind->velocity.allFinite()) {
      return refuse("wind: expected three finite numbers as its velocity");
    }
    if (!isNotNegative(command.wind->density) || !isNotNegative(command.wind->dragCoefficient)) {
      return refuse("wind: expected a density and a drag coefficient >= 0");
    }
  }
  controls_.wind = command.wind;
  return done();
}

CommandResult Simulation::carryOut(const SetStiffness& command) {
  if (!(command.scale >= 1.0 / kMostScale && command.scale <= kMostScale)) {
    return refuse("stiffness: expected a scale of 1e-3 ... 1e3");
  }
  if (command.scale == model_.springs.scale()) return done();
  ModelChanges changes;
  changes.mesh.fromRevision = changes.mesh.toRevision = model_.mesh.revision();
  model_.bending.scaleBy(command.scale / model_.springs.scale());
  changes.springs = model_.springs.setScale(model_.mesh, command.scale);
  solver_->onModelChanged(model_, changes);
  topology_.reset();  // it tells the longest stable step
  return done();
}

CommandResult Simulation::carryOut(const PullParticle& command) {
  if (!command.held) {
    drag_.release();
    return done();
  }
  const std::string defect = validationError(command.ray);
  if (!defect.empty()) return refuse(defect);
  if (!drag_.pick(command.ray, state_)) {
    return refuse("no particle is within " + std::to_string(static_cast<int>(Drag::kReach * 1e3)) +
                  " mm of the ray");
  }
  drag_.aim(command.ray, time());
  return done();
}

}  // namespace cloth_sim
