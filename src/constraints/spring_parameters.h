#pragma once
/// \file Constants of springs, side by side.

#include <algorithm>
#include <cstddef>
#include <vector>

#include "cloth_sim/cloth/spring.h"

namespace cloth_sim {

/// Keeps the direction of a spring of no length from being 0/0 [m^2].
constexpr double kTinySquare = 1e-300;

/// Parameters as structure of arrays; without stiffness where a spring is gone. Dashpots take no
/// memory where there are none.
class SpringParameterTable {
 public:
  std::size_t size() const { return restLength_.size(); }
  SpringParameters operator[](std::int32_t k) const {
    return {restLength_[k], stiffness_[k], damped() ? damping_[k] : 0.0};
  }
  /// Some spring has or had a dashpot.
  bool damped() const { return damped_; }
  const std::vector<double>& restLength() const { return restLength_; }
  const std::vector<double>& stiffness() const { return stiffness_; }
  /// Nothing unless `damped()`.
  const std::vector<double>& damping() const { return damping_; }

  void append(const SpringParameters& parameters) {
    resize(size() + 1);
    set(static_cast<std::int32_t>(size()) - 1, parameters);
  }
  void set(std::int32_t k, const SpringParameters& parameters) {
    restLength_[k] = parameters.restLength;
    stiffness_[k] = parameters.stiffness;
    if (parameters.damping > 0.0 && !damped_) {
      damped_ = true;
      damping_.assign(size(), 0.0);
    }
    if (damped_) damping_[k] = parameters.damping;
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

/// Sequences of parameters that several runs of springs have, and that are there once.
class ParameterPatterns {
 public:
  /// \param lawAt  of spring k in [0, count)
  /// \return where in `all` a run has its parameters: with those of another run, or added for
  /// others to come; or kNone if it is too long for that, or there are many sequences already.
  template <typename LawAt>
  std::int32_t place(std::int32_t count, const LawAt& lawAt, SpringParameterTable& all) {
    if (count > kLongest) return kNone;
    const auto isSame = [&](const Pattern& pattern) {
      std::int32_t k = 0;
      while (k < count && pattern.count == count && all[pattern.first + k] == lawAt(k)) ++k;
      return k == count;
    };
    const auto known = std::find_if(patterns_.begin(), patterns_.end(), isSame);
    if (known != patterns_.end()) return known->first;
    if (patterns_.size() == kMost) return kNone;
    patterns_.push_back({static_cast<std::int32_t>(all.size()), count});
    for (std::int32_t k = 0; k < count; ++k) all.append(lawAt(k));
    return patterns_.back().first;
  }

 private:
  struct Pattern {
    std::int32_t first = 0;
    std::int32_t count = 0;
  };
  /// So that they stay in the first-level cache ...
  static constexpr std::int32_t kLongest = 1024;
  /// ... and are soon looked through. A grid has one for each length of its runs.
  static constexpr std::size_t kMost = 16;

  std::vector<Pattern> patterns_;
};

}  // namespace cloth_sim
