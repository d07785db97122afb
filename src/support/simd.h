#pragma once
/// \file Four doubles or eight floats in a SIMD register, for kernels that compilers do not
/// vectorise themselves. Vector extensions that GCC and clang share; no intrinsics.

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

constexpr std::int32_t kFloatLanes = 8;

/// Eight floats: a register of AVX2, or two of SSE2. In memory it may begin at any float.
using FloatLanes =
    float __attribute__((vector_size(kFloatLanes * sizeof(float)), aligned(4), may_alias));
/// Four floats: half of `FloatLanes`.
using FloatHalf = float __attribute__((vector_size(16), aligned(4), may_alias));

[[gnu::always_inline]] inline const FloatLanes& floatLanesAt(const float* p) {
  return *reinterpret_cast<const FloatLanes*>(p);
}
[[gnu::always_inline]] inline FloatHalf& floatHalfAt(float* p) {
  return *reinterpret_cast<FloatHalf*>(p);
}

[[gnu::always_inline]] inline FloatLanes sqrt(const FloatLanes& of) {
  float each[kFloatLanes];  // by way of memory, as above
  *reinterpret_cast<FloatLanes*>(each) = of;
  for (float& it : each) it = std::sqrt(it);
  return floatLanesAt(each);
}

// GCC before 12 has no __builtin_shufflevector. A test takes the way of old compilers, too.
#if !defined(CLOTH_SIM_PLAIN_SHUFFLES) && \
    (defined(__clang__) || (defined(__GNUC__) && __GNUC__ >= 12))

[[gnu::always_inline]] inline FloatLanes join(const FloatHalf& low, const FloatHalf& high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
[[gnu::always_inline]] inline FloatHalf lowHalf(const FloatLanes& of) {
  return __builtin_shufflevector(of, of, 0, 1, 2, 3);
}
[[gnu::always_inline]] inline FloatHalf highHalf(const FloatLanes& of) {
  return __builtin_shufflevector(of, of, 4, 5, 6, 7);
}
/// Transposes the 4 x 4 matrix whose rows are a, b, c and d.
[[gnu::always_inline]] inline void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  const Lanes ab02 = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Lanes ab13 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Lanes cd02 = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Lanes cd13 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab02, cd02, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab13, cd13, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab02, cd02, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab13, cd13, 2, 3, 6, 7);
}
/// Transposes the two 4 x 4 matrices whose rows are the halves of a, b, c and d.
[[gnu::always_inline]] inline void transposeHalves(FloatLanes& a, FloatLanes& b, FloatLanes& c,
                                                   FloatLanes& d) {
  const FloatLanes ab01 = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  const FloatLanes ab23 = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  const FloatLanes cd01 = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
  const FloatLanes cd23 = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  a = __builtin_shufflevector(ab01, cd01, 0, 1, 8, 9, 4, 5, 12, 13);
  b = __builtin_shufflevector(ab01, cd01, 2, 3, 10, 11, 6, 7, 14, 15);
  c = __builtin_shufflevector(ab23, cd23, 0, 1, 8, 9, 4, 5, 12, 13);
  d = __builtin_shufflevector(ab23, cd23, 2, 3, 10, 11, 6, 7, 14, 15);
}

#else

[[gnu::always_inline]] inline FloatLanes join(const FloatHalf& low, const FloatHalf& high) {
  return FloatLanes{low[0], low[1], low[2], low[3], high[0], high[1], high[2], high[3]};
}
[[gnu::always_inline]] inline FloatHalf lowHalf(const FloatLanes& of) {
  return FloatHalf{of[0], of[1], of[2], of[3]};
}
[[gnu::always_inline]] inline FloatHalf highHalf(const FloatLanes& of) {
  return FloatHalf{of[4], of[5], of[6], of[7]};
}
[[gnu::always_inline]] inline void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  const Lanes p = a, q = b, r = c, s = d;
  a = Lanes{p[0], q[0], r[0], s[0]};
  b = Lanes{p[1], q[1], r[1], s[1]};
  c = Lanes{p[2], q[2], r[2], s[2]};
  d = Lanes{p[3], q[3], r[3], s[3]};
}
[[gnu::always_inline]] inline void transposeHalves(FloatLanes& a, FloatLanes& b, FloatLanes& c,
                                                   FloatLanes& d) {
  const FloatLanes p = a, q = b, r = c, s = d;
  a = FloatLanes{p[0], q[0], r[0], s[0], p[4], q[4], r[4], s[4]};
  b = FloatLanes{p[1], q[1], r[1], s[1], p[5], q[5], r[5], s[5]};
  c = FloatLanes{p[2], q[2], r[2], s[2], p[6], q[6], r[6], s[6]};
  d = FloatLanes{p[3], q[3], r[3], s[3], p[7], q[7], r[7], s[7]};
}

#endif

}  // namespace cloth_sim
