#pragma once
/// \file Which particles springs join.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// Particles joined by springs into connected sets.
class ConnectedSets {
 public:
  explicit ConnectedSets(std::int32_t particles)
      : parent_(static_cast<std::size_t>(particles), kNone) {}

  /// The smallest particle of the set.
  std::int32_t rootOf(std::int32_t p) const {
    while (parent_[p] != p) p = parent_[p];
    return p;
  }
  void join(std::int32_t a, std::int32_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return;
    parent_[std::max(a, b)] = std::min(a, b);
    --count_;
  }
  std::int32_t count() const { return count_; }
  /// Particles from the first to the last of the set that stretches the furthest.
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

  std::vector<std::int32_t> parent_;  ///< kNone: not seen yet
  std::int32_t count_ = 0;
};

}  // namespace cloth_sim
