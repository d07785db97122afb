#include "bisection.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace cloth_sim {

Bisection bisectLimit(const BisectionRange& range, const std::function<bool(double)>& holds) {
  if (!(range.low > 0.0) || !(range.high > range.low) || !(range.resolution > 0.0)) {
    throw std::invalid_argument("bisectLimit: expected 0 < low < high and resolution > 0");
  }
  Bisection result;
  const auto ask = [&](double value) {
    result.probes.push_back({value, holds(value)});
    return result.probes.back().holds;
  };
  if (!ask(range.low)) return result;
  if (ask(range.high)) {
    result.limit = std::numeric_limits<double>::infinity();
    return result;
  }
  double low = range.low, high = range.high;
  while (high > low * (1.0 + range.resolution)) {
    const double middle = std::sqrt(low * high);
    (ask(middle) ? low : high) = middle;
  }
  result.limit = std::sqrt(low * high);
  return result;
}

}  // namespace cloth_sim
