#include "cloth_sim/cloth/spring.h"

#include "cloth_sim/hash.h"

namespace cloth_sim {
namespace {

/// Makes that are looked for before a new one is entered; a power of two.
constexpr std::size_t kKnownMakes = 1024;

std::size_t hashOf(const Spring& spring) {
  Hash hash;
  for (const double value : {spring.restLength, spring.stiffness}) hash.add(&value, sizeof value);
  return static_cast<std::size_t>(hash.value()) & (kKnownMakes - 1);
}

}  // namespace

const char* toString(SpringKind kind) {
  switch (kind) {
    case SpringKind::kStructural:
      return "structural";
    case SpringKind::kShear:
      return "shear";
    case SpringKind::kBend:
      return "bend";
  }
  return "?";
}

bool Spring::operator==(const Spring& other) const {
  return a == other.a && b == other.b && support == other.support && kind == other.kind &&
         direction == other.direction && law() == other.law();
}

void SpringSlots::append(const Spring& spring) {
  slots_.emplace_back();
  set(static_cast<std::int32_t>(size()) - 1, spring);
}

void SpringSlots::set(std::int32_t slot, const Spring& spring) {
  Slot& at = slots_[static_cast<std::size_t>(slot)];
  leave(at.make);
  at = {spring.a, spring.b, spring.support, spring.exists() ? enter(spring) : kNone};
}

std::int32_t SpringSlots::enter(const Spring& spring) {
  if (known_.empty()) known_.assign(kKnownMakes, kNone);
  std::int32_t& known = known_[hashOf(spring)];
  if (known != kNone) {
    Make& make = makes_[static_cast<std::size_t>(known)];
    const bool same = make.springs > 0 && make.kind == spring.kind &&
                      make.direction == spring.direction && make.law == spring.law();
    if (same) {
      ++make.springs;
      return known;
    }
  }
  if (unused_.empty()) {
    unused_.push_back(static_cast<std::int32_t>(makes_.size()));
    makes_.emplace_back();
  }
  known = unused_.back();
  unused_.pop_back();
  makes_[static_cast<std::size_t>(known)] = {spring.law(), spring.kind, spring.direction, 1};
  return known;
}

void SpringSlots::leave(std::int32_t make) {
  if (make != kNone && --makes_[static_cast<std::size_t>(make)].springs == 0) {
    unused_.push_back(make);
  }
}

}  // namespace cloth_sim
