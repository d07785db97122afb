#pragma once
/// \file How far four springs are from what they allow.

#include "spring_parameters.h"
#include "support/simd.h"

namespace cloth_sim {

/// From end a to end b of four springs.
struct FourOffsets {
  Lanes x, y, z;
};

/// What a correction is divided by besides the length [1/kg].
/// \param w  inverse masses of both ends together.
template <typename Number>
[[gnu::always_inline]] inline Number giveOf(const Number& w, const Number& alpha,
                                            const Number& lag) {
  return (1.0 + lag) * w + alpha;
}

/// The corrections over the offsets [kg]. Times the inverse mass of an end and the offset it is
/// what that end moves by.
/// \param start  offsets at the start of the substep; only where there are dashpots, as `lag`.
template <bool kDamped>
[[gnu::always_inline]] inline Lanes factorsOf(const FourOffsets& d, const Lanes& rest,
                                              const Lanes& give, const Lanes& lag,
                                              const FourOffsets& start) {
  const Lanes squared = d.x * d.x + d.y * d.y + d.z * d.z + kTinySquare;
  const Lanes length = sqrt(squared);
  if constexpr (kDamped) {
    const Lanes moved = (squared - d.x * start.x - d.y * start.y - d.z * start.z) / length;
    return (length - rest + lag * moved) / (length * give);
  } else {
    return (length - rest) / (length * give);
  }
}

}  // namespace cloth_sim
