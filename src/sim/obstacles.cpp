#include "cloth_sim/sim/obstacles.h"

#include <algorithm>

namespace cloth_sim {
namespace {

/// Distance by which a particle may be pulled in one step beyond its own speed times dt and still
/// be among the contact candidates, at least [m].
constexpr double kContactReach = 0.05;
/// An obstacle that moves by less than this in a step stands still: its guide rounds [m].
constexpr double kPoseRoundOff = 1e-12;

}  // namespace

std::vector<std::string> Obstacles::names() const {
  std::vector<std::string> names;
  for (const Collider& collider : colliders_.all()) names.push_back(collider.obstacle().name);
  return names;
}

void Obstacles::place(const std::string& obstacle, const Pose& pose, const Vec3& velocity,
                      double time) {
  Collider* collider = colliders_.find(obstacle);
  if (collider == nullptr) return;
  guides_.drop(obstacle);
  collider->place(pose, velocity, time);
}

void Obstacles::setVelocity(const std::string& obstacle, const Vec3& velocity, double time,
                            const Vec3& angularVelocity) {
  Collider* collider = colliders_.find(obstacle);
  if (collider == nullptr) return;
  guides_.drop(obstacle);
  collider->place(collider->poseAt(time), velocity, time, angularVelocity);
}

void Obstacles::guide(const std::string& obstacle, const MovingPose& target) {
  guides_.set(obstacle, target);
}

void Obstacles::detect(const Model& model, const State& state, double dt, bool meetsSharpFeatures) {
  if (colliders_.all().empty()) return;
  span_ = dt;
  const MotionBounds bounds = motionBounds(state);
  const TriangleMesh noFaces;
  // A particle that rests may be pulled along by the fastest one.
  colliders_.detect(state, bounds, dt, std::max(kContactReach, bounds.speed * dt),
                    meetsSharpFeatures ? model.mesh : noFaces, contacts_);
  if (model.cloths.size() == 1) return;
  contacts_.splitByCloth(model.cloths.size(), [&model](VertexId v) { return model.clothOf(v); });
}

std::vector<Wrench> Obstacles::wrenches(double time) const {
  const std::vector<Collider>& all = colliders_.all();
  std::vector<Wrench> wrenches(all.size());
  if (span_ <= 0.0) return wrenches;
  for (const ContactCandidates& near : contacts_.candidates) {
    const auto index = static_cast<std::size_t>(near.collider - all.data());
    const Vec3 origin = all[index].poseAt(time).position;
    wrenches[index].force += near.impulse.linear / span_;
    wrenches[index].torque += (near.impulse.angular - origin.cross(near.impulse.linear)) / span_;
  }
  return wrenches;
}

bool Obstacles::areTouched() const {
  return std::any_of(
      contacts_.candidates.begin(), contacts_.candidates.end(),
      [](const ContactCandidates& c) { return c.impulse.linear.squaredNorm() > 0.0; });
}

bool Obstacles::areStill(double time, double dt) const {
  const auto stands = [dt](const Collider& collider) {
    return !collider.turns() && collider.obstacle().velocity.norm() * dt <= kPoseRoundOff;
  };
  const std::vector<Collider>& all = colliders_.all();
  return std::all_of(all.begin(), all.end(), stands) && guides_.areIdle(time, colliders_);
}

void Obstacles::shiftTime(double by) {
  for (Collider& collider : colliders_.all()) collider.shiftTime(by);
}

}  // namespace cloth_sim
