#pragma once
/// \file A low-pass filter for wrenches.

#include "cloth_sim/clamp/clamp.h"

namespace cloth_sim {

/// Low-pass filter of first order, exact for inputs that are constant between samples.
class WrenchFilter {
 public:
  /// \param cutoff  frequency at which the gain is 1/sqrt(2) [Hz]; 0: no filtering.
  explicit WrenchFilter(double cutoff) : cutoff_(cutoff) {}

  /// Filters a sample. \param time  simulated [s]; a smaller time than before resets the filter.
  Wrench filter(double time, const Wrench& wrench);

 private:
  double cutoff_;
  std::optional<double> time_;
  Wrench value_;
};

}  // namespace cloth_sim
