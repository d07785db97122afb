#pragma once
/// \file How many steps a stretch of time is divided into.

#include <algorithm>
#include <cmath>

namespace cloth_sim {

/// The least number of equal steps, at least one, for `ratio` times the longest step: so that a
/// third of three substeps is one, what rounding adds to the ratio is not worth a step.
inline int stepCount(double ratio) {
  constexpr double kRounding = 1e-9;
  return std::max(1, static_cast<int>(std::ceil(ratio - kRounding)));
}

}  // namespace cloth_sim
