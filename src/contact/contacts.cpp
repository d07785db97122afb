#include "cloth_sim/contact/contacts.h"

#include <algorithm>
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

void Contacts::dropLast() {
  candidates.back().vertices.clear();
  spare_.push_back(std::move(candidates.back().vertices));
  candidates.pop_back();
}

void Contacts::divide(std::size_t cloths, const std::function<std::size_t(VertexId)>& clothOf) {
  std::vector<ContactCandidates> found;
  found.swap(candidates);
  for (ContactCandidates& whole : found) {
    const std::size_t first = candidates.size();
    for (std::size_t cloth = 0; cloth < cloths; ++cloth) add(whole.collider, cloth);
    for (const VertexId v : whole.vertices) candidates[first + clothOf(v)].vertices.push_back(v);
    whole.vertices.clear();
    spare_.push_back(std::move(whole.vertices));
  }
  const auto isEmpty = [](const ContactCandidates& entry) { return entry.vertices.empty(); };
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(), isEmpty), candidates.end());
}

void Contacts::project(const ParticleView& particles, double time, double h) {
  for (ContactCandidates& entry : candidates) {
    entry.collider->project(entry.vertices, particles, time, h, entry.impulse, entry.cloth);
  }
}

}  // namespace cloth_sim
