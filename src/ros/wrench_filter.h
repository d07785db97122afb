#pragma once
/// \file A low-pass over a wrench.

#include "cloth_sim/clamp/clamp.h"

namespace cloth_sim {

/// First order, exact for inputs that are constant between samples.
class WrenchFilter {
 public:
  /// \param cutoff  frequency at which the gain is 1/sqrt(2) [Hz]; 0: lets everything pass.
  explicit WrenchFilter(double cutoff) : cutoff_(cutoff) {}

  /// \param time  of the sample, simulated [s]; going back begins anew.
  Wrench filter(double time, const Wrench& wrench);

 private:
  double cutoff_;
  std::optional<double> time_;
  Wrench value_;
};

}  // namespace cloth_sim
