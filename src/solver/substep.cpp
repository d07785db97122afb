#include "substep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cloth_sim/contact/collider.h"
#include "cloth_sim/contact/layers.h"
#include "linalg/vector_operations.h"

namespace cloth_sim {

bool Substep::isOver() const {
  return isStopped() || (contacts.layers != nullptr && contacts.layers->hasComeNear());
}

void Substep::markStart() { copy(particles.x, particles.start); }

void Substep::addLoads() {
  if (controls.wind) addWind(*controls.wind);
  for (const PointForce& load : controls.forces) {
    const auto k = static_cast<std::size_t>(particles.slotOf[load.vertex]);
    force.set(k, force.at(k) + load.force);
  }
}

void Substep::addWind(const Wind& wind) {
  sumWind(wind);
  for (std::size_t k = 0; k < windSpeeds.size(); ++k) {
    const Vec3 blown = scratch.at(k);
    const double most = windSpeeds[k] * particles.mass[k] / h;
    const double size = blown.norm();
    const bool isLimited = particles.mass[k] > 0.0 && size > most;
    force.set(k, force.at(k) + (isLimited ? most / size : 1.0) * blown);
  }
}

/// Finds the force of the wind on each particle, in `scratch`, and the largest speed of the air
/// along the normals of its faces.
void Substep::sumWind(const Wind& wind) {
  setZero(particles.mass.size(), scratch);
  windSpeeds.assign(particles.mass.size(), 0.0);
  const VectorArray& x = particles.x;
  const VectorArray& v = particles.v;
  for (const Face& face : model.mesh.faces()) {
    std::array<std::size_t, 3> p;
    for (int k = 0; k < 3; ++k) p[k] = static_cast<std::size_t>(particles.slotOf[face[k]]);
    // Twice the area times the unit normal.
    const Vec3 normal = (x.at(p[1]) - x.at(p[0])).cross(x.at(p[2]) - x.at(p[0]));
    const double length = normal.norm();
    if (length == 0.0) continue;
    const Vec3 relative = wind.velocity - (v.at(p[0]) + v.at(p[1]) + v.at(p[2])) / 3.0;
    const double along = relative.dot(normal) / length;
    const Vec3 third =
        wind.density * wind.dragCoefficient * std::abs(along) * along / 12.0 * normal;
    for (const std::size_t k : p) {
      scratch.set(k, scratch.at(k) + third);
      windSpeeds[k] = std::max(windSpeeds[k], std::abs(along));
    }
  }
}

bool Substep::isBlocked(const ParticleView& paths) const {
  for (const ContactCandidates& candidates : contacts.candidates) {
    for (const VertexId v : candidates.vertices) {
      const std::int32_t k = paths.slot(v);
      if (paths.mass[k] > 0.0 && candidates.collider->gap(paths.at(k), time) < 0.0) return true;
    }
    // A path may lead through a thin obstacle and out of it.
    if (candidates.collider->stops(candidates.vertices, paths, time, h, candidates.cloth))
      return true;
  }
  return false;
}

bool Substep::isFlightBlocked() {
  if (contacts.empty()) return false;
  VectorArray& ahead = scratch;
  ahead.resize(particles.mass.size());
  const Vec3 fall = h * h * controls.gravity;
  forFreeCandidates(
      [&](std::size_t k) { ahead.set(k, particles.x.at(k) + h * particles.v.at(k) + fall); });
  ParticleView paths = particles.view();
  paths.x = ahead.x.data();
  paths.y = ahead.y.data();
  paths.z = ahead.z.data();
  return isBlocked(paths);
}

void Substep::enforceContacts() {
  if (contacts.empty()) return;
  Particles& p = particles;
  VectorArray& unprojected = scratch;
  unprojected.resize(p.mass.size());
  forFreeCandidates([&](std::size_t k) { unprojected.set(k, p.x.at(k)); });
  contacts.project(p.view(), time, h);
  // A particle near two obstacles is visited twice; the second visit finds no displacement left.
  forFreeCandidates([&](std::size_t k) {
    p.v.set(k, p.v.at(k) + (p.x.at(k) - unprojected.at(k)) / h);
    unprojected.set(k, p.x.at(k));
  });
}

void Substep::enforceContactVelocities() {
  if (contacts.empty()) return;
  Particles& p = particles;
  VectorArray& ahead = scratch;
  ahead.resize(p.mass.size());
  forFreeCandidates([&](std::size_t k) {
    p.start.set(k, p.x.at(k));
    ahead.set(k, p.x.at(k) + h * p.v.at(k));
  });
  forFreeCandidates([&](std::size_t k) { p.x.set(k, ahead.at(k)); });
  // Layers have been certified where they are; this is only an outlook.
  LayerContact* const layers = std::exchange(contacts.layers, nullptr);
  contacts.project(p.view(), time, h);
  contacts.layers = layers;
  VectorArray& velocity = scratch;
  forFreeCandidates([&](std::size_t k) { velocity.set(k, (p.x.at(k) - p.start.at(k)) / h); });
  forFreeCandidates([&](std::size_t k) {
    p.v.set(k, velocity.at(k));
    p.x.set(k, p.start.at(k));
  });
}

/// Calls `visit(slot)` for every particle that contacts may move and that is free to.
template <typename Visit>
void Substep::forFreeCandidates(const Visit& visit) const {
  if (contacts.layers != nullptr) {
    for (std::size_t k = 0; k < particles.mass.size(); ++k) {
      if (particles.mass[k] > 0.0) visit(k);
    }
    return;
  }
  for (const ContactCandidates& candidates : contacts.candidates) {
    for (const VertexId v : candidates.vertices) {
      const auto k = static_cast<std::size_t>(particles.slotOf[v]);
      if (particles.mass[k] > 0.0) visit(k);
    }
  }
}

}  // namespace cloth_sim
