#include "cloth_sim/cloth/spring.h"

#include <cmath>

#include "support/hash.h"

namespace cloth_sim {
namespace {

/// Size of the hash table of recently added types, as a power of two. A cloth has few types until
/// edits give many springs parameters of their own; those would not be found again anyway.
constexpr int kTableBits = 10;
/// Buckets that a search looks at. If all of them hold other types, the first is overwritten.
constexpr std::size_t kProbes = 4;

/// The bucket of the spring's type. Rest lengths that differ by a factor of two differ in few high
/// bits, so the bits of the hash are mixed once more by multiplicative hashing (Knuth, The Art of
/// Computer Programming 3, section 6.4).
std::size_t bucketOf(const Spring& spring) {
  Hash hash;
  for (const double value : {spring.restLength, spring.stiffness}) hash.add(&value, sizeof value);
  hash.add(&spring.kind, sizeof spring.kind);
  hash.add(&spring.direction, sizeof spring.direction);
  constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15U;  // 2^64 over the golden ratio
  return static_cast<std::size_t>(hash.value() * kGolden >> (64 - kTableBits));
}

}  // namespace

ThreadDirection threadDirection(const Vec2& direction) {
  static const double threadCosine = std::cos(M_PI / 8.0);
  const double least = threadCosine * direction.norm();
  if (std::abs(direction.x()) > least) return ThreadDirection::kWarp;
  if (std::abs(direction.y()) > least) return ThreadDirection::kWeft;
  return ThreadDirection::kBias;
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
  releaseType(at.type);
  at = {spring.a, spring.b, spring.support, spring.exists() ? acquireType(spring) : kNone};
}

/// Finds the type of a spring by linear probing, or adds it.
/// \return its index into types_.
std::int32_t SpringSlots::acquireType(const Spring& spring) {
  if (recent_.empty()) recent_.assign(std::size_t{1} << kTableBits, kNone);
  const std::size_t bucket = bucketOf(spring);
  std::size_t freeBucket = bucket;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const std::size_t at = (bucket + probe) % recent_.size();
    const std::int32_t candidate = recent_[at];
    if (candidate == kNone) {
      freeBucket = at;
      break;
    }
    Type& type = types_[static_cast<std::size_t>(candidate)];
    if (type.users == 0) {
      freeBucket = at;
    } else if (type.kind == spring.kind && type.direction == spring.direction &&
               type.parameters == spring.parameters()) {
      ++type.users;
      return candidate;
    }
  }
  if (unused_.empty()) {
    unused_.push_back(static_cast<std::int32_t>(types_.size()));
    types_.emplace_back();
  }
  const std::int32_t added = unused_.back();
  unused_.pop_back();
  types_[static_cast<std::size_t>(added)] = {spring.parameters(), spring.kind, spring.direction, 1};
  recent_[freeBucket] = added;
  return added;
}

void SpringSlots::releaseType(std::int32_t type) {
  if (type != kNone && --types_[static_cast<std::size_t>(type)].users == 0) {
    unused_.push_back(type);
  }
}

}  // namespace cloth_sim
