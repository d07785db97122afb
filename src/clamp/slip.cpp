/// \file Grips of limited force: when they yield, and how the cloth slides through the plates.

#include <algorithm>
#include <cmath>

#include "cloth_sim/clamp/clamp.h"

namespace cloth_sim {
namespace {

bool isWithin(const Vec3& p, const Vec3& half) {
  return ((half - p.cwiseAbs()).array() >= 0.0).all();
}

const KinematicTarget* findTarget(const std::vector<KinematicTarget>& targets, VertexId vertex) {
  const auto it =
      std::lower_bound(targets.begin(), targets.end(), vertex,
                       [](const KinematicTarget& target, VertexId v) { return target.vertex < v; });
  return it != targets.end() && it->vertex == vertex ? &*it : nullptr;
}

}  // namespace

bool Clamp::yield(const std::vector<KinematicTarget>& targets, const std::vector<Vec3>& reactions) {
  if (!spec_.gripForce || held_.empty() || slip_.on) return false;
  Vec3 pull = Vec3::Zero();
  for (const VertexId vertex : held_) {
    const KinematicTarget* target = findTarget(targets, vertex);
    if (target != nullptr) pull += reactions[static_cast<std::size_t>(target - targets.data())];
  }
  const double size = pull.norm();
  if (!(size > *spec_.gripForce)) return false;
  slip_.on = true;
  slip_.direction = pull / size;
  slip_.box = {0.5 * spec_.plateSize.x(), 0.5 * spec_.plateSize.y(), 0.5 * spec_.gapOpen};
  for (const Grip& grip : grips_) slip_.box = slip_.box.cwiseMax(grip.local.cwiseAbs());
  return true;
}

double Clamp::heldMass(const Model& model) const {
  double mass = 0.0;
  for (const VertexId v : held_) mass += model.mass[v];
  return mass;
}

/// Returns the velocity of the held particles relative to the clamp, averaged by mass [m/s].
Vec3 Clamp::slidingVelocity(const Model& model, const State& state) const {
  Vec3 momentum = Vec3::Zero();
  for (const VertexId v : held_) {
    const Vec3 arm = state.x[v] - pose_.position;
    momentum += model.mass[v] * (state.v[v] - linearVelocity_ - angularVelocity_.cross(arm));
  }
  return momentum / heldMass(model);
}

/// Updates the places of sliding particles, and lets go of those that have left the plates. When
/// the direction of sliding reverses, the clamp holds them where they are; if that takes more than
/// the grip force, it yields again.
void Clamp::slide(const Model& model, const State& state, double dt) {
  if (!slip_.on) return;
  for (Grip& grip : grips_) grip.local = pose_.toLocal(state.x[grip.vertex]);
  const auto left = [this](const Grip& grip) { return !isWithin(grip.local, slip_.box); };
  grips_.erase(std::remove_if(grips_.begin(), grips_.end(), left), grips_.end());
  updateHeld();
  slip_.on = !held_.empty() && spec_.gripForce;
  if (!slip_.on) return;
  const Vec3 sliding = slidingVelocity(model, state);
  const double along = sliding.dot(slip_.direction);
  if (along <= 0.0) {
    slip_.on = false;
    return;
  }
  // Across the direction, friction must not reverse the motion within a step: so this component is
  // integrated implicitly.
  const double speed = sliding.norm();
  const double braking = *spec_.gripForce * dt / (heldMass(model) * speed);
  const Vec3 across = (sliding - along * slip_.direction) / (1.0 + braking);
  slip_.direction = (along * slip_.direction + across).normalized();
  slip_.distance += speed * dt;
}

void Clamp::appendForces(const Model& model, std::vector<PointForce>& out) const {
  if (!slip_.on) return;
  const double perMass = *spec_.gripForce / heldMass(model);
  for (const VertexId v : held_) out.push_back({v, -perMass * model.mass[v] * slip_.direction});
}

void Clamp::addSlipWrench(const Model& model, const State& state, double fraction) {
  if (!slip_.on) return;
  const double perMass = fraction * *spec_.gripForce / heldMass(model);
  for (const VertexId v : held_) {
    const Vec3 force = perMass * model.mass[v] * slip_.direction;
    wrench_.force += force;
    wrench_.torque += (state.x[v] - pose_.position).cross(force);
  }
}

}  // namespace cloth_sim
