#include "turns.h"

#include <algorithm>

namespace cloth_sim::bench {
namespace {

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

double Turns::median(const std::string& name) const { return medianOf(seconds_.at(name)); }

double Turns::medianOver(const std::string& name, const std::string& other) const {
  std::vector<double> ratios = seconds_.at(name);
  const std::vector<double>& divisors = seconds_.at(other);
  for (std::size_t k = 0; k < ratios.size(); ++k) ratios[k] /= divisors.at(k);
  return medianOf(std::move(ratios));
}

}  // namespace cloth_sim::bench
