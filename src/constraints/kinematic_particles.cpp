#include "kinematic_particles.h"

#include <algorithm>

#include "cloth_sim/contact/collider.h"

namespace cloth_sim {

bool KinematicParticles::load(const Controls& controls, const Particles& particles) {
  slots_.clear();
  startVelocity_.clear();
  from_.resize(controls.kinematic.size());
  to_.resize(controls.kinematic.size());
  impulses_.assign(controls.kinematic.size(), Vec3::Zero());
  for (const KinematicTarget& target : controls.kinematic) {
    const std::int32_t slot = particles.slotOf[target.vertex];
    from_.set(slots_.size(), particles.x.at(slot));
    to_.set(slots_.size(), target.position);
    slots_.push_back(slot);
    startVelocity_.push_back(particles.v.at(slot));
  }
  const bool areOthers = slots_ != previous_;
  if (areOthers) previous_ = slots_;
  return areOthers;
}

void KinematicParticles::indexSlots(std::int32_t slots) {
  targetOf_.assign(static_cast<std::size_t>(slots), kNone);
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    targetOf_[static_cast<std::size_t>(slots_[k])] = static_cast<std::int32_t>(k);
  }
}

void KinematicParticles::keepOutOf(const Contacts& contacts, const Controls& controls, double end,
                                   double dt) {
  noMass_.assign(slots_.size(), 0.0);
  const ParticleView view = particleView(to_, from_, noMass_.data());
  for (const ContactCandidates& candidates : contacts.candidates) {
    near_.clear();
    for (std::size_t k = 0; k < slots_.size(); ++k) {
      const VertexId v = controls.kinematic[k].vertex;
      const std::vector<VertexId>& vertices = candidates.vertices;
      if (std::binary_search(vertices.begin(), vertices.end(), v)) {
        near_.push_back(static_cast<VertexId>(k));
      }
    }
    ContactImpulse impulse;
    candidates.collider->project(near_, view, end, dt, impulse, candidates.cloth);
  }
}

void KinematicParticles::setVelocities(double dt, Particles& particles) const {
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    particles.v.set(static_cast<std::size_t>(slots_[k]), (to_.at(k) - from_.at(k)) / dt);
  }
}

void KinematicParticles::place(double fraction, Particles& particles) const {
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    const Vec3 from = from_.at(k);
    particles.x.set(static_cast<std::size_t>(slots_[k]), from + fraction * (to_.at(k) - from));
  }
}

void KinematicParticles::addForces(double h, const VectorArray& force) {
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    impulses_[k] += h * force.at(static_cast<std::size_t>(slots_[k]));
  }
}

void KinematicParticles::findReactions(const Model& model, const Controls& controls, double dt,
                                       std::vector<Vec3>& reactions) const {
  reactions.resize(slots_.size());
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    const KinematicTarget& target = controls.kinematic[k];
    const double mass = model.mass[target.vertex];
    const Vec3 acceleration = (target.velocity - startVelocity_[k]) / dt;
    reactions[k] = impulses_[k] / dt + mass * (controls.gravity - acceleration);
  }
}

}  // namespace cloth_sim
