#pragma once
/// \file Fewer cases where each takes much longer, as with sanitizers (scripts/test.sh).

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <vector>

namespace cloth_sim {

/// Says of how many cases one is to run: CLOTH_SIM_FEWER_CASES; 1, for all of them, if it is not
/// set.
inline int casesForOne() {
  const char* number = std::getenv("CLOTH_SIM_FEWER_CASES");
  return number == nullptr ? 1 : std::max(1, std::atoi(number));
}

/// The number of random cases to run of `count`; at least 1.
inline int fewerCases(int count) { return std::max(1, count / casesForOne()); }

/// The cases to run of a list: the last one and every so many before it, in their order.
template <typename T>
std::vector<T> fewerCasesOf(const std::vector<T>& all) {
  const auto step = static_cast<std::size_t>(casesForOne());
  std::vector<T> chosen;
  for (std::size_t k = all.empty() ? 0 : (all.size() - 1) % step; k < all.size(); k += step) {
    chosen.push_back(all[k]);
  }
  return chosen;
}

}  // namespace cloth_sim
