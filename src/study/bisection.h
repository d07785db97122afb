#pragma once
/// \file Bisection for the limit below which a property holds.

#include <functional>
#include <vector>

namespace cloth_sim {

/// One value that was tested.
struct Probe {
  double value = 0.0;
  bool holds = false;
};

struct Bisection {
  /// Between the largest value that holds and the smallest that does not; 0 if it does not hold at
  /// the lower end, infinity if it holds at the upper one.
  double limit = 0.0;
  std::vector<Probe> probes;  ///< in the order of the tests
};

/// The interval of the search, which bisects on a logarithmic scale.
struct BisectionRange {
  double low = 0.0;           ///< > 0
  double high = 0.0;          ///< > low
  double resolution = 0.005;  ///< relative width of the last bracket, > 0
};

/// Bisects for the limit. \throws std::invalid_argument unless 0 < low < high and resolution > 0.
Bisection bisectLimit(const BisectionRange& range, const std::function<bool(double)>& holds);

}  // namespace cloth_sim
