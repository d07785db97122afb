#include "spring_matches.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace cloth_sim {
namespace {

/// Identifies a spring by its support and its ends, each pair of vertices in one word and in
/// ascending order.
using SpringKey = std::array<std::uint64_t, 2>;

std::uint64_t packPair(VertexId p, VertexId q) {
  const auto low = static_cast<std::uint32_t>(std::min(p, q));
  const auto high = static_cast<std::uint32_t>(std::max(p, q));
  return (std::uint64_t{low} << 32U) | high;
}

SpringKey makeKey(VertexId s, VertexId t, VertexId a, VertexId b) {
  return {packPair(s, t), packPair(a, b)};
}

SpringKey keyOf(const Spring& spring) {
  return makeKey(spring.support[0], spring.support[1], spring.a, spring.b);
}

/// A spring, given by an index, and the key that it had before an edit.
struct KeyedSpring {
  SpringKey key;
  std::int32_t value;
  bool operator<(const KeyedSpring& other) const {
    if (key[0] != other.key[0]) return key[0] < other.key[0];
    return key[1] != other.key[1] ? key[1] < other.key[1] : value < other.value;
  }
};

/// Maps the copies of vertices that an edit made to the vertices that they are copies of.
class Ancestors {
 public:
  explicit Ancestors(const MeshChanges& changes) {
    for (const VertexEdit& edit : changes.vertices) {
      if (edit.kind == VertexEdit::Kind::kCopy) source_.emplace(edit.id, of(edit.from[0]));
    }
  }
  VertexId of(VertexId v) const {
    const auto found = source_.find(v);
    return found == source_.end() ? v : found->second;
  }
  SpringKey key(const Spring& s) const {
    return makeKey(of(s.support[0]), of(s.support[1]), of(s.a), of(s.b));
  }

 private:
  std::map<VertexId, VertexId> source_;
};

/// Pairs old and derived springs of equal keys.
/// \return all of both, ascending by key.
std::vector<SpringMatch> matchByKey(std::vector<KeyedSpring> old,
                                    std::vector<KeyedSpring> derived) {
  std::sort(old.begin(), old.end());
  std::sort(derived.begin(), derived.end());
  std::vector<SpringMatch> matches;
  matches.reserve(std::max(old.size(), derived.size()));
  auto at = old.begin();
  for (const auto& [key, k] : derived) {
    for (; at != old.end() && at->key < key; ++at) matches.push_back({at->value, kNone});
    const bool continues = at != old.end() && at->key == key;
    matches.push_back({continues ? at->value : kNone, k});
    if (continues) ++at;
  }
  for (; at != old.end(); ++at) matches.push_back({at->value, kNone});
  return matches;
}

}  // namespace

std::vector<SpringMatch> matchSprings(const SpringSlots& slots,
                                      const std::vector<std::int32_t>& old,
                                      const std::vector<Spring>& derived,
                                      const MeshChanges& changes) {
  std::vector<KeyedSpring> before;
  before.reserve(old.size());
  for (const std::int32_t slot : old) before.push_back({keyOf(slots[slot]), slot});
  std::vector<KeyedSpring> after;
  after.reserve(derived.size());
  const Ancestors ancestors(changes);
  for (std::size_t k = 0; k < derived.size(); ++k) {
    after.push_back({ancestors.key(derived[k]), static_cast<std::int32_t>(k)});
  }
  return matchByKey(std::move(before), std::move(after));
}

std::vector<VertexId> newIdsAfter(const MeshChanges& changes, std::int32_t vertexCount) {
  std::vector<VertexId> newId(static_cast<std::size_t>(vertexCount) + changes.vertices.size());
  std::iota(newId.begin(), newId.end(), 0);
  std::vector<VertexId> original = newId;  // by the id at the present edit
  for (const VertexEdit& edit : changes.vertices) {
    newId[original[edit.id]] = kNone;
    if (edit.from[0] != edit.id) newId[original[edit.from[0]]] = edit.id;
    original[edit.id] = original[edit.from[0]];
  }
  return newId;
}

Spring renumbered(Spring spring, const std::vector<VertexId>& newId) {
  for (VertexId* v : {&spring.a, &spring.b, &spring.support[0], &spring.support[1]}) {
    *v = *v == kNone ? kNone : newId[*v];
  }
  if (!spring.exists()) return spring;
  if (spring.a > spring.b) std::swap(spring.a, spring.b);
  if (spring.support[1] != kNone && spring.support[0] > spring.support[1]) {
    std::swap(spring.support[0], spring.support[1]);
  }
  return spring;
}

}  // namespace cloth_sim
