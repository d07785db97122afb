#include "contact_warm_start.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cloth_sim/contact/collider.h"

namespace cloth_sim {
namespace {

/// Fraction of a force that the next substep begins with. With all of it, a cloth that falls on a
/// sphere is thrown up again; below 0.9, the cloth is strained on obstacles as without warm
/// starting (docs/decisions/032-contact-warm-starting.md).
constexpr double kKeep = 0.95;

/// The same where friction is larger than the push. A remembered force then moves a particle
/// further along the obstacle than its push does away from it, and what it stores in springs grows
/// from substep to substep: with 0.9, a cotton of 26 g that fell on a sphere with a friction of 10
/// got 2,700 J, with 0.5 the sphere takes energy away.
constexpr double kKeepWhereRough = 0.5;
constexpr double kRough = 1.0;  ///< friction above which that holds [-]

double keptFraction(const Contacts& contacts) {
  const auto isRough = [](const ContactCandidates& near) {
    return near.collider->friction(near.cloth) > kRough;
  };
  const auto& all = contacts.candidates;
  return std::any_of(all.begin(), all.end(), isRough) ? kKeepWhereRough : kKeep;
}

/// Marks a slot that is listed already, in the place of an index.
constexpr std::int32_t kListed = -2;
static_assert(kListed != kNone, "a mark of its own");

}  // namespace

void ContactWarmStart::begin(const Contacts& contacts, const Particles& particles, double time,
                             double h) {
  if (std::abs(time - startTime_) < 0.5 * h) {
    now_ = atStart_;
  } else {
    atStart_ = now_;
  }
  startTime_ = time;
  keep_ = keptFraction(contacts);
  if (contacts.empty() && now_.slots.empty()) return;
  indexOf_.resize(static_cast<std::size_t>(particles.slots), kNone);
  for (std::size_t k = 0; k < now_.slots.size(); ++k) {
    indexOf_[static_cast<std::size_t>(now_.slots[k])] = static_cast<std::int32_t>(k);
  }
  listed_.slots.clear();
  listed_.acceleration.clear();
  for (const ContactCandidates& near : contacts.candidates) {
    for (const VertexId v : near.vertices) {
      const std::int32_t slot = particles.slotOf[v];
      if (particles.mass[static_cast<std::size_t>(slot)] > 0.0) list(slot);
    }
  }
  for (const Forces* forces : {&now_, &listed_}) {
    for (const std::int32_t slot : forces->slots) indexOf_[static_cast<std::size_t>(slot)] = kNone;
  }
  std::swap(now_, listed_);
}

/// A particle near two obstacles comes by twice.
void ContactWarmStart::list(std::int32_t slot) {
  std::int32_t& index = indexOf_[static_cast<std::size_t>(slot)];
  if (index == kListed) return;
  const bool isKnown = index != kNone;
  listed_.slots.push_back(slot);
  listed_.acceleration.push_back(isKnown ? now_.acceleration[static_cast<std::size_t>(index)]
                                         : Vec3::Zero());
  index = kListed;
}

void ContactWarmStart::addForces(const ScalarArray& mass, VectorArray& force) const {
  for (std::size_t k = 0; k < now_.slots.size(); ++k) {
    const auto slot = static_cast<std::size_t>(now_.slots[k]);
    force.set(slot, force.at(slot) + mass[slot] * now_.acceleration[k]);
  }
}

void ContactWarmStart::enforce(double time, double h, Contacts& contacts, Particles& particles) {
  if (contacts.empty()) return;
  VectorArray& x = particles.x;
  for (std::size_t k = 0; k < now_.slots.size(); ++k) {
    const auto slot = static_cast<std::size_t>(now_.slots[k]);
    const Vec3 without = x.at(slot) - h * h * now_.acceleration[k];
    x.set(slot, without);
    now_.acceleration[k] = without;
  }
  contacts.project(particles.view(), time, h);
  for (std::size_t k = 0; k < now_.slots.size(); ++k) {
    const auto slot = static_cast<std::size_t>(now_.slots[k]);
    now_.acceleration[k] = keep_ / (h * h) * (x.at(slot) - now_.acceleration[k]);
    particles.v.set(slot, (x.at(slot) - particles.start.at(slot)) / h);
  }
}

bool ContactWarmStart::fits(std::size_t slots) const {
  if (now_.acceleration.size() != now_.slots.size()) return false;
  std::vector<bool> isTaken(slots, false);
  for (const std::int32_t slot : now_.slots) {
    const auto k = static_cast<std::size_t>(slot);
    if (slot < 0 || k >= slots || isTaken[k]) return false;
    isTaken[k] = true;
  }
  return true;
}

}  // namespace cloth_sim
