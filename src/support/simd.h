#pragma once
/// \file Four numbers side by side, for kernels that the compiler does not vectorise by itself.

#include <cmath>
#include <cstdint>

// Functions that take or return vectors are inlined wherever they are called: they have no ABI.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace cloth_sim {

constexpr std::int32_t kLanes = 4;

/// May begin at any double. One register of AVX2, or two of SSE2.
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double)), aligned(8), may_alias));

/// `kLanes` numbers from p on.
[[gnu::always_inline]] inline Lanes& lanesAt(double* p) { return *reinterpret_cast<Lanes*>(p); }
[[gnu::always_inline]] inline const Lanes& lanesAt(const double* p) {
  return *reinterpret_cast<const Lanes*>(p);
}

/// The same number in every lane.
[[gnu::always_inline]] inline Lanes allLanes(double of) { return Lanes{of, of, of, of}; }

/// p[at[0]], p[at[1]] ...
[[gnu::always_inline]] inline Lanes gather(const double* p, const std::int32_t* at) {
  return Lanes{p[at[0]], p[at[1]], p[at[2]], p[at[3]]};
}

/// The reverse. What two lanes write to one place has to be the same.
[[gnu::always_inline]] inline void scatter(const Lanes& of, double* p, const std::int32_t* at) {
  for (std::int32_t lane = 0; lane < kLanes; ++lane) p[at[lane]] = of[lane];
}

[[gnu::always_inline]] inline Lanes sqrt(const Lanes& of) {
  double each[kLanes];  // in memory, or the compiler takes the roots one by one
  lanesAt(each) = of;
  for (double& it : each) it = std::sqrt(it);
  return lanesAt(each);
}

}  // namespace cloth_sim
