#pragma once
/// \file Where a property that holds below a limit ceases to hold.

#include <functional>
#include <vector>

namespace cloth_sim {

/// One question that the bisection asked.
struct Probe {
  double value = 0.0;
  bool holds = false;
};

struct Bisection {
  /// Between the largest value that holds and the smallest that does not; 0 if it does not hold at
  /// the lower end, infinity if it holds at the upper one.
  double limit = 0.0;
  std::vector<Probe> probes;  ///< in the order of asking
};

/// Where to look, on a logarithmic scale.
struct BisectionRange {
  double low = 0.0;           ///< > 0
  double high = 0.0;          ///< > low
  double resolution = 0.005;  ///< relative width of the last bracket, > 0
};

/// \throws std::invalid_argument if the range is none.
Bisection bisectLimit(const BisectionRange& range, const std::function<bool(double)>& holds);

}  // namespace cloth_sim
