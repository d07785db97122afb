#include "cloth_sim/contact/contacts.h"

#include <utility>

#include "cloth_sim/contact/collider.h"

namespace cloth_sim {

void Contacts::clear() {
  // Last first: `add` then hands the buffers out in the order in which they were used.
  while (!candidates.empty()) dropLast();
}

ContactCandidates& Contacts::add(const Collider* collider, std::size_t cloth) {
  ContactCandidates& entry = candidates.emplace_back();
  entry.collider = collider;
  entry.cloth = cloth;
  if (!spare_.empty()) {
    entry.vertices = std::move(spare_.back());
    spare_.pop_back();
  }
  return entry;
}

void Contacts::keepMemoryOf(std::vector<VertexId>& vertices) {
  vertices.clear();
  spare_.push_back(std::move(vertices));
}

void Contacts::dropLast() {
  keepMemoryOf(candidates.back().vertices);
  candidates.pop_back();
}

void Contacts::divide(std::size_t cloths, const std::function<std::size_t(VertexId)>& clothOf) {
  whole_.swap(candidates);
  for (ContactCandidates& whole : whole_) {
    for (std::size_t cloth = 0; cloth < cloths; ++cloth) {
      ContactCandidates& part = add(whole.collider, cloth);
      for (const VertexId v : whole.vertices) {
        if (clothOf(v) == cloth) part.vertices.push_back(v);
      }
      if (part.vertices.empty()) dropLast();
    }
  }
  for (ContactCandidates& whole : whole_) keepMemoryOf(whole.vertices);
  whole_.clear();
}

void Contacts::project(const ParticleView& particles, double time, double h) {
  for (ContactCandidates& entry : candidates) {
    entry.collider->project(entry.vertices, particles, time, h, entry.impulse, entry.cloth);
  }
}

}  // namespace cloth_sim
