#include "cloth_sim/contact/collider.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "geometry.h"

namespace cloth_sim {
namespace {

/// \tparam Colliders  std::vector<Collider>, const or not.
template <typename Colliders>
auto findNamed(Colliders& colliders, const std::string& name) {
  const auto named = [&](const Collider& it) { return it.obstacle().name == name; };
  const auto found = std::find_if(colliders.begin(), colliders.end(), named);
  return found != colliders.end() ? &*found : nullptr;
}

void require(bool holds, const Obstacle& obstacle, const char* what) {
  if (!holds) throw std::invalid_argument("obstacle '" + obstacle.name + "': " + what);
}

bool notNegative(double value) { return std::isfinite(value) && value >= 0.0; }

bool isPositive(double length) { return std::isfinite(length) && length > 0.0; }
bool isPositive(const Vec3& size) { return size.allFinite() && size.minCoeff() > 0.0; }

bool isSound(const PlaneShape&) { return true; }
bool isSound(const SphereShape& shape) { return isPositive(shape.radius); }
bool isSound(const CapsuleShape& shape) {
  return isPositive(shape.radius) && isPositive(shape.length);
}
bool isSound(const BoxShape& shape) { return isPositive(shape.size); }
bool isSound(const BoundsShape& shape) { return isPositive(shape.size); }

}  // namespace

Collider::Collider(Obstacle obstacle, std::vector<ContactSkin> skins)
    : obstacle_(std::move(obstacle)), skins_(std::move(skins)) {
  const bool sound = std::visit([](const auto& shape) { return isSound(shape); }, obstacle_.shape);
  require(sound, obstacle_, "expected lengths > 0");
  require(!skins_.empty(), obstacle_, "expected a cloth to meet");
  for (const ContactSkin& skin : skins_) {
    require(notNegative(skin.margin), obstacle_, "expected a margin >= 0");
    require(notNegative(obstacle_.friction.value_or(skin.friction)), obstacle_,
            "expected a friction coefficient >= 0");
  }
  require(notNegative(obstacle_.tangentialDecay), obstacle_, "expected a tangential decay >= 0");
  obstacle_.pose.orientation.normalize();
}

double Collider::margin() const {
  double largest = 0.0;
  for (const ContactSkin& skin : skins_) largest = std::max(largest, skin.margin);
  return largest;
}

Pose Collider::poseAt(double time) const {
  Pose pose = obstacle_.pose;
  pose.position += obstacle_.velocity * (time - referenceTime_);
  return pose;
}

void Collider::place(const Pose& pose, const Vec3& velocity, double time) {
  obstacle_.pose = pose;
  obstacle_.pose.orientation.normalize();
  obstacle_.velocity = velocity;
  referenceTime_ = time;
}

double Collider::gap(const Vec3& point, double time) const {
  const Vec3 relative = point - poseAt(time).position;
  return geometry::visit(*this, [&](const auto& solid) { return solid.gap(relative); });
}

Vec3 Collider::normal(const Vec3& point, double time) const {
  const Vec3 relative = point - poseAt(time).position;
  Vec3 result = Vec3::Zero();
  geometry::visit(*this, [&](const auto& solid) { solid.gap(relative, result); });
  return result;
}

void ColliderSet::add(Obstacle obstacle, std::vector<ContactSkin> skins) {
  colliders_.emplace_back(std::move(obstacle), std::move(skins));
}

const Collider* ColliderSet::find(const std::string& name) const {
  return findNamed(colliders_, name);
}

Collider* ColliderSet::find(const std::string& name) { return findNamed(colliders_, name); }

}  // namespace cloth_sim
