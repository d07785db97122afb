#include "cloth_sim/cloth/spring.h"

#include "support/hash.h"

namespace cloth_sim {
namespace {

/// Makes that are looked for before a new one is entered: two to the power of this.
constexpr int kKnownBits = 10;
/// Places where one of them may be; the next one takes the first if others have them all.
constexpr std::size_t kProbes = 4;

/// Springs of twice the length differ in few high bits of it; so all bits of the hash count (Knuth,
/// The Art of Computer Programming 3, 6.4: multiplicative hashing).
std::size_t hashOf(const Spring& spring) {
  Hash hash;
  for (const double value : {spring.restLength, spring.stiffness}) hash.add(&value, sizeof value);
  hash.add(&spring.kind, sizeof spring.kind);
  hash.add(&spring.direction, sizeof spring.direction);
  constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15U;  // 2^64 over the golden ratio
  return static_cast<std::size_t>(hash.value() * kGolden >> (64 - kKnownBits));
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
         direction == other.direction && parameters() == other.parameters();
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
  if (known_.empty()) known_.assign(std::size_t{1} << kKnownBits, kNone);
  const std::size_t home = hashOf(spring);
  std::size_t place = home;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const std::size_t at = (home + probe) % known_.size();
    const std::int32_t known = known_[at];
    if (known == kNone) {
      place = at;
      break;
    }
    Make& make = makes_[static_cast<std::size_t>(known)];
    if (make.springs == 0) {
      place = at;
    } else if (make.kind == spring.kind && make.direction == spring.direction &&
               make.parameters == spring.parameters()) {
      ++make.springs;
      return known;
    }
  }
  if (unused_.empty()) {
    unused_.push_back(static_cast<std::int32_t>(makes_.size()));
    makes_.emplace_back();
  }
  known_[place] = unused_.back();
  unused_.pop_back();
  makes_[static_cast<std::size_t>(known_[place])] = {spring.parameters(), spring.kind,
                                                     spring.direction, 1};
  return known_[place];
}

void SpringSlots::leave(std::int32_t make) {
  if (make != kNone && --makes_[static_cast<std::size_t>(make)].springs == 0) {
    unused_.push_back(make);
  }
}

}  // namespace cloth_sim
