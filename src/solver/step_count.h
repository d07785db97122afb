#pragma once
/// \file The number of equal steps that a duration is divided into.

#include <algorithm>
#include <cmath>

namespace cloth_sim {

/// The least number of steps, at least one, for a duration of `ratio` times the longest step.
/// Rounding in the ratio does not add a step: a third of three substeps is one.
inline int stepCount(double ratio) {
  constexpr double kRounding = 1e-9;
  return std::max(1, static_cast<int>(std::ceil(ratio - kRounding)));
}

}  // namespace cloth_sim
