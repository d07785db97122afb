#include "cloth_sim/contact/collider.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "feature_meeting.h"
#include "support/rotation.h"

namespace cloth_sim {
namespace {

void require(bool holds, const Obstacle& obstacle, const std::string& error) {
  if (!holds) throw std::invalid_argument("obstacle '" + obstacle.name + "': " + error);
}

bool isNotNegative(double value) { return std::isfinite(value) && value >= 0.0; }

/// The first collider of that name in a vector that may be const; nullptr if there is none.
template <class Colliders>
auto findByName(Colliders& colliders, const std::string& name) -> decltype(colliders.data()) {
  const auto found =
      std::find_if(colliders.begin(), colliders.end(),
                   [&](const Collider& collider) { return collider.obstacle().name == name; });
  return found == colliders.end() ? nullptr : &*found;
}

}  // namespace

Collider::Collider(Obstacle obstacle, std::vector<ContactProperties> properties)
    : obstacle_(std::move(obstacle)), properties_(std::move(properties)) {
  const std::string shapeError = validationError(obstacle_.shape);
  require(shapeError.empty(), obstacle_, shapeError);
  require(!properties_.empty(), obstacle_, "expected the contact properties of at least one cloth");
  for (const ContactProperties& cloth : properties_) {
    require(isNotNegative(cloth.margin), obstacle_, "expected a margin >= 0");
    require(isNotNegative(obstacle_.friction.value_or(cloth.friction)), obstacle_,
            "expected a friction coefficient >= 0");
  }
  require(isNotNegative(obstacle_.tangentialDecay), obstacle_, "expected a tangential decay >= 0");
  obstacle_.pose.orientation.normalize();
  sharpSurface_ = sharpSurface(obstacle_.shape);
  if (sharpSurface_ != nullptr) {
    auto features = std::make_shared<const SharpFeatures>(*sharpSurface_);
    if (!features->empty()) features_ = std::move(features);
  }
}

double Collider::margin() const {
  double largest = 0.0;
  for (const ContactProperties& cloth : properties_) largest = std::max(largest, cloth.margin);
  return largest;
}

Pose Collider::poseAt(double time) const {
  Pose pose = obstacle_.pose;
  pose.position += obstacle_.velocity * (time - referenceTime_);
  pose.orientation = turned(pose.orientation, obstacle_.angularVelocity, time - referenceTime_);
  return pose;
}

void Collider::place(const Pose& pose, const Vec3& velocity, double time,
                     const Vec3& angularVelocity) {
  obstacle_.pose = pose;
  obstacle_.pose.orientation.normalize();
  obstacle_.velocity = velocity;
  obstacle_.angularVelocity = angularVelocity;
  referenceTime_ = time;
}

double Collider::gap(const Vec3& point, double time) const {
  const Pose pose = poseAt(time);
  const Vec3 relative = point - pose.position;
  return visitGeometry(obstacle_.shape, pose.orientation, margin(),
                       [&](const auto& solid) { return solid.gap(relative); });
}

Vec3 Collider::normal(const Vec3& point, double time) const {
  const Pose pose = poseAt(time);
  const Vec3 relative = point - pose.position;
  Vec3 result = Vec3::Zero();
  visitGeometry(obstacle_.shape, pose.orientation, margin(),
                [&](const auto& solid) { solid.gap(relative, result); });
  return result;
}

NearTriangles* Collider::nearTriangles(std::size_t count) const {
  if (!std::holds_alternative<MeshShape>(obstacle_.shape)) return nullptr;
  if (near_.size() < count) near_.resize(count);
  return near_.data();
}

PlacedFeatures Collider::placedFeatures(const Pose& pose) const {
  return {*sharpSurface_, *features_, pose.position, pose.orientation.toRotationMatrix()};
}

void ColliderSet::add(Obstacle obstacle, std::vector<ContactProperties> properties) {
  colliders_.emplace_back(std::move(obstacle), std::move(properties));
}

const Collider* ColliderSet::find(const std::string& name) const {
  return findByName(colliders_, name);
}

Collider* ColliderSet::find(const std::string& name) { return findByName(colliders_, name); }

}  // namespace cloth_sim
