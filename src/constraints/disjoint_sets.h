#pragma once
/// \file Connected components of particles and springs.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// A disjoint-set forest over particle slots, with path halving (Tarjan 1975). A particle belongs
/// to no set until it is joined to another one.
class DisjointSets {
 public:
  explicit DisjointSets(std::int32_t particles)
      : parent_(static_cast<std::size_t>(particles), kNone) {}

  /// The smallest particle of the set that `p` belongs to.
  std::int32_t rootOf(std::int32_t p) const {
    while (parent_[p] != p) p = parent_[p];
    return p;
  }
  /// Merges the sets of two particles.
  void join(std::int32_t a, std::int32_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return;
    parent_[std::max(a, b)] = std::min(a, b);
    --count_;
  }
  /// Number of sets.
  std::int32_t count() const { return count_; }
  /// Slots from the first to the last particle of the set that spans the most slots.
  std::int32_t widest() const {
    std::int32_t most = 0;
    for (std::int32_t p = 0; p < static_cast<std::int32_t>(parent_.size()); ++p) {
      if (parent_[p] != kNone) most = std::max(most, p - rootOf(p) + 1);
    }
    return most;
  }

 private:
  std::int32_t find(std::int32_t p) {
    if (parent_[p] == kNone) {
      parent_[p] = p;
      ++count_;
    }
    while (parent_[p] != p) p = parent_[p] = parent_[parent_[p]];
    return p;
  }

  std::vector<std::int32_t> parent_;  ///< by slot; kNone: in no set yet
  std::int32_t count_ = 0;
};

}  // namespace cloth_sim
