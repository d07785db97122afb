#pragma once
/// \file Constants of springs, side by side.

#include <cstddef>
#include <vector>

#include "cloth_sim/cloth/spring.h"

namespace cloth_sim {

/// Keeps the direction of a spring of no length from being 0/0 [m^2].
constexpr double kTinySquare = 1e-300;

/// Laws as structure of arrays; without stiffness where a spring is gone. Dashpots take no memory
/// where there are none.
class SpringLaws {
 public:
  std::size_t size() const { return restLength_.size(); }
  SpringLaw operator[](std::int32_t k) const {
    return {restLength_[k], stiffness_[k], damped() ? damping_[k] : 0.0};
  }
  /// Some spring has or had a dashpot.
  bool damped() const { return damped_; }
  const std::vector<double>& restLength() const { return restLength_; }
  const std::vector<double>& stiffness() const { return stiffness_; }
  /// Nothing unless `damped()`.
  const std::vector<double>& damping() const { return damping_; }

  void append(const SpringLaw& law) {
    resize(size() + 1);
    set(static_cast<std::int32_t>(size()) - 1, law);
  }
  void set(std::int32_t k, const SpringLaw& law) {
    restLength_[k] = law.restLength;
    stiffness_[k] = law.stiffness;
    if (law.damping > 0.0 && !damped_) {
      damped_ = true;
      damping_.assign(size(), 0.0);
    }
    if (damped_) damping_[k] = law.damping;
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

}  // namespace cloth_sim
