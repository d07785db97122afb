#pragma once
/// \file Four doubles in a SIMD register, for kernels that compilers do not vectorise themselves.
/// Vector extensions that GCC and clang share; no intrinsics.

#include <cmath>
#include <cstdint>

// Every function that takes or returns vectors is inlined, so that their ABI does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace cloth_sim {

constexpr std::int32_t kLanes = 4;

/// Four doubles: a register of AVX2, or two of SSE2. In memory it may begin at any double.
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double)), aligned(8), may_alias));

/// The four doubles from p on.
[[gnu::always_inline]] inline Lanes& lanesAt(double* p) { return *reinterpret_cast<Lanes*>(p); }
[[gnu::always_inline]] inline const Lanes& lanesAt(const double* p) {
  return *reinterpret_cast<const Lanes*>(p);
}

/// The doubles p[at[0]], p[at[1]], p[at[2]], p[at[3]].
[[gnu::always_inline]] inline Lanes gather(const double* p, const std::int32_t* at) {
  return Lanes{p[at[0]], p[at[1]], p[at[2]], p[at[3]]};
}

/// Writes p[at[k]] = of[k] for each lane k; the places have to be different.
[[gnu::always_inline]] inline void scatter(const Lanes& of, double* p, const std::int32_t* at) {
  for (std::int32_t lane = 0; lane < kLanes; ++lane) p[at[lane]] = of[lane];
}

[[gnu::always_inline]] inline Lanes sqrt(const Lanes& of) {
  double each[kLanes];  // by way of memory: otherwise GCC takes four scalar roots
  lanesAt(each) = of;
  for (double& it : each) it = std::sqrt(it);
  return lanesAt(each);
}

}  // namespace cloth_sim
