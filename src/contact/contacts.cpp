#include "cloth_sim/contact/contacts.h"

#include <utility>

#include "cloth_sim/contact/collider.h"

namespace cloth_sim {

void Contacts::clear() {
  // Last first: `add` then hands the buffers out in the order in which they were used.
  while (!candidates.empty()) dropLast();
}

ContactCandidates& Contacts::add(const Collider* collider) {
  ContactCandidates& entry = candidates.emplace_back();
  entry.collider = collider;
  if (!spare_.empty()) {
    entry.vertices = std::move(spare_.back());
    spare_.pop_back();
  }
  return entry;
}

void Contacts::dropLast() {
  candidates.back().vertices.clear();
  spare_.push_back(std::move(candidates.back().vertices));
  candidates.pop_back();
}

void Contacts::project(const ParticleView& particles, double time, double h) {
  for (ContactCandidates& entry : candidates) {
    entry.collider->project(entry.vertices, particles, time, h, entry.impulse);
  }
}

}  // namespace cloth_sim
