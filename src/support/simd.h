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

/// Transposes the 4 x 4 matrix with the rows a, b, c, d.
[[gnu::always_inline]] inline void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
#if defined(__clang__) || (defined(__GNUC__) && __GNUC__ >= 12)
  const Lanes ab02 = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Lanes ab13 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Lanes cd02 = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Lanes cd13 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab02, cd02, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab13, cd13, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab02, cd02, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab13, cd13, 2, 3, 6, 7);
#else
  const Lanes p = a, q = b, r = c, s = d;
  a = Lanes{p[0], q[0], r[0], s[0]};
  b = Lanes{p[1], q[1], r[1], s[1]};
  c = Lanes{p[2], q[2], r[2], s[2]};
  d = Lanes{p[3], q[3], r[3], s[3]};
#endif
}

}  // namespace cloth_sim
