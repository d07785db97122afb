#include "cloth_sim/contact/contacts.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "cloth_sim/contact/collider.h"
#include "cloth_sim/contact/layers.h"

namespace cloth_sim {

void Contacts::clear() {
  // From the last entry on, so that `add` reuses the buffers in the same order.
  while (!candidates.empty()) dropLast();
}

ContactCandidates& Contacts::add(const Collider* collider, std::size_t cloth) {
  ContactCandidates& entry = candidates.emplace_back();
  entry.collider = collider;
  entry.cloth = cloth;
  if (!spare_.empty()) {
    entry.vertices = std::move(spare_.back().vertices);
    entry.pairs = std::move(spare_.back().pairs);
    spare_.pop_back();
  }
  return entry;
}

void Contacts::keepBuffers(ContactCandidates& entry) {
  entry.vertices.clear();
  entry.pairs.clear();
  spare_.push_back({std::move(entry.vertices), std::move(entry.pairs)});
}

void Contacts::dropLast() {
  keepBuffers(candidates.back());
  candidates.pop_back();
}

void Contacts::splitByCloth(std::size_t cloths,
                            const std::function<std::size_t(VertexId)>& clothOf) {
  unsplit_.swap(candidates);
  for (ContactCandidates& unsplit : unsplit_) {
    for (std::size_t cloth = 0; cloth < cloths; ++cloth) {
      ContactCandidates& part = add(unsplit.collider, cloth);
      for (const VertexId v : unsplit.vertices) {
        if (clothOf(v) == cloth) part.vertices.push_back(v);
      }
      for (const FeaturePair& pair : unsplit.pairs) {
        if (clothOf(pair.cloth[0]) == cloth) part.pairs.push_back(pair);
      }
      if (part.vertices.empty() && part.pairs.empty()) dropLast();
    }
  }
  for (ContactCandidates& unsplit : unsplit_) keepBuffers(unsplit);
  unsplit_.clear();
}

/// Obstacles come first, so that layers meet what carries them; and again for the vertices that
/// layers have pushed into them.
void Contacts::project(const ParticleView& particles, double time, double h) {
  if (layers != nullptr) layers->load(particles);
  for (ContactCandidates& entry : candidates) {
    projectObstacle(entry, entry.vertices, particles, time, h);
  }
  if (layers == nullptr) return;
  layers->project(particles, h);
  if (layers->carriesLoad()) {
    for (ContactCandidates& entry : candidates) {
      projectObstacle(entry, pushedOf(entry), particles, time, h);
    }
    layers->settle(particles, h);
  }
  layers->certify(particles);
}

/// Returns the vertices of an entry that layers have pushed.
const std::vector<VertexId>& Contacts::pushedOf(const ContactCandidates& entry) {
  pushed_.clear();
  std::set_intersection(entry.vertices.begin(), entry.vertices.end(), layers->pushed().begin(),
                        layers->pushed().end(), std::back_inserter(pushed_));
  return pushed_;
}

/// \param vertices  of the entry, or some of them, ascending.
void Contacts::projectObstacle(ContactCandidates& entry, const std::vector<VertexId>& vertices,
                               const ParticleView& particles, double time, double h) {
  const Collider& collider = *entry.collider;
  collider.projectFeatures(entry.pairs, particles, time, h, entry.impulse, entry.cloth);
  collider.project(vertices, particles, time, h, entry.impulse, entry.cloth);
  collider.certifyFeatures(entry.pairs, particles, time, h, entry.impulse);
}

}  // namespace cloth_sim
