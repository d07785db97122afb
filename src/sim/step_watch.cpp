#include "cloth_sim/sim/step_watch.h"

#include <algorithm>
#include <cmath>

namespace cloth_sim {
namespace {

/// Speed at which obstacles push out particles that began inside of them [m/s].
constexpr double kPushOut = 1.0;
/// Largest factor by which the energy swings with a method that nearly conserves it.
constexpr double kSwing = 2.0;
/// Two attempts whose energies agree within this factor are right: the energy did come in.
constexpr double kAgree = 1.2;

/// Returns the speed of the fastest thing that pushes the cloth in this step [m/s].
double drivingSpeed(const State& state, const Controls& controls, const ColliderSet& colliders,
                    double dt) {
  double fastest = controls.wind ? controls.wind->velocity.norm() : 0.0;
  for (const KinematicTarget& target : controls.kinematic) {
    const double mean = (target.position - state.x[target.vertex]).norm() / dt;
    fastest = std::max({fastest, mean, target.velocity.norm()});
  }
  for (const Collider& collider : colliders.all()) {
    double speed = collider.obstacle().velocity.norm() + kPushOut;
    if (collider.turns()) {
      const Vec3 centre = collider.poseAt(state.t).position;
      double farthest = 0.0;
      for (const Vec3& x : state.x) farthest = std::max(farthest, (x - centre).norm());
      speed += farthest * collider.obstacle().angularVelocity.norm();
    }
    fastest = std::max(fastest, speed);
  }
  return fastest;
}

}  // namespace

StepWatch::StepWatch(const SolverSpec& solver, int substeps)
    : redoes_(solver.guard != StepGuard::kAllow),
      checksEnergy_(redoes_ && std::isfinite(findSolver(solver.method).stabilityLimit)) {
  record_.chosenSubsteps = substeps;
  const auto configured = solver.parameters.find("substeps");
  if (configured != solver.parameters.end()) {
    record_.configuredSubsteps = static_cast<int>(configured->second);
  }
}

void StepWatch::begin(const Model& model, const State& state, const Controls& controls,
                      const ColliderSet& colliders, double dt) {
  if (!checksEnergy_) return;
  gravity_ = controls.gravity;
  // Cloth that is driven at a speed leaves at twice that speed at most.
  const double speed = 2.0 * drivingSpeed(state, controls, colliders, dt);
  input_ = std::sqrt(0.5 * totalMass(model)) * speed;
  const Energies e = energies(model, state, gravity_);
  height_ = e.gravity;
  // Slow growth from step to step does not raise the budget; losses lower it.
  const double now = kSwing * (e.kinetic + e.elastic);
  budget_ = budget_ < 0.0 ? now : std::min(budget_, now);
  previousEnergy_ = 0.0;
}

bool StepWatch::endedWell(const Model& model, const State& state, StepStatus status) {
  if (status == StepStatus::kDiverged) return false;
  if (!checksEnergy_) return true;
  const Energies e = energies(model, state, gravity_);
  const double energy = e.kinetic + e.elastic;
  const double root = std::sqrt(budget_ + std::max(0.0, height_ - e.gravity)) + input_;
  const bool agrees = previousEnergy_ > 0.0 && std::max(energy, previousEnergy_) <=
                                                   kAgree * std::min(energy, previousEnergy_);
  previousEnergy_ = energy;
  nextBudget_ = std::max(root * root, agrees ? energy : 0.0);
  return energy <= kSwing * root * root || agrees;
}

void StepWatch::accept() {
  if (checksEnergy_) budget_ = nextBudget_;
}

void StepWatch::noteRedone(double time, int factor) {
  ++record_.redone;
  record_.finest = std::max(record_.finest, factor);
  record_.lastRedone = time;
}

}  // namespace cloth_sim
