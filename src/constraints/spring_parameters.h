#pragma once
/// \file Spring parameters in the order of a schedule, as structure of arrays.

#include <algorithm>
#include <cstddef>
#include <vector>

#include "cloth_sim/cloth/spring.h"

namespace cloth_sim {

/// Added to squared lengths, so that the direction of a spring of no length is not 0/0 [m^2].
constexpr double kTinySquare = 1e-300;

/// Rest lengths [m], stiffnesses [N/m] and dashpots [N s/m], an array each. A spring that is gone
/// has no stiffness. Dashpots take no memory where there are none.
class SpringParameterTable {
 public:
  std::size_t size() const { return restLength_.size(); }
  SpringParameters operator[](std::int32_t k) const {
    return {restLength_[k], stiffness_[k], damped() ? damping_[k] : 0.0};
  }
  /// Tells whether some spring has, or had, a dashpot.
  bool damped() const { return damped_; }
  const std::vector<double>& restLength() const { return restLength_; }
  const std::vector<double>& stiffness() const { return stiffness_; }
  /// Empty unless `damped()`.
  const std::vector<double>& damping() const { return damping_; }

  void append(const SpringParameters& spring) {
    resize(size() + 1);
    set(static_cast<std::int32_t>(size()) - 1, spring);
  }
  void set(std::int32_t k, const SpringParameters& spring) {
    restLength_[k] = spring.restLength;
    stiffness_[k] = spring.stiffness;
    if (spring.damping > 0.0 && !damped_) {
      damped_ = true;
      damping_.assign(size(), 0.0);
    }
    if (damped_) damping_[k] = spring.damping;
  }
  void resize(std::size_t n) {
    restLength_.resize(n);
    stiffness_.resize(n);
    if (damped_) damping_.resize(n);
  }

 private:
  std::vector<double> restLength_, stiffness_, damping_;
  bool damped_ = false;
};

/// Stores a sequence of parameters once that several spans of springs have. All rows of a grid
/// share the few sequences there are, which then stay in the first-level cache.
class ParameterPatterns {
 public:
  /// Finds a sequence among those stored, or appends it to `table`.
  /// \param parametersAt  of the k-th spring, k in [0, count).
  /// \return where the sequence begins in `table`; kNone if it is too long to be shared or there
  /// are
  ///         too many sequences already (nothing is appended then).
  template <typename ParametersAt>
  std::int32_t place(std::int32_t count, const ParametersAt& parametersAt,
                     SpringParameterTable& table) {
    if (count > kLongest) return kNone;
    const auto isSame = [&](const Pattern& pattern) {
      std::int32_t k = 0;
      while (k < count && pattern.count == count && table[pattern.first + k] == parametersAt(k)) {
        ++k;
      }
      return k == count;
    };
    const auto known = std::find_if(patterns_.begin(), patterns_.end(), isSame);
    if (known != patterns_.end()) return known->first;
    if (patterns_.size() == kMost) return kNone;
    patterns_.push_back({static_cast<std::int32_t>(table.size()), count});
    for (std::int32_t k = 0; k < count; ++k) table.append(parametersAt(k));
    return patterns_.back().first;
  }

 private:
  struct Pattern {
    std::int32_t first = 0;
    std::int32_t count = 0;
  };
  static constexpr std::int32_t kLongest = 1024;  ///< springs; 24 KB fit the first-level cache
  static constexpr std::size_t kMost = 64;        ///< sequences; a grid has some twenty

  std::vector<Pattern> patterns_;
};

}  // namespace cloth_sim
