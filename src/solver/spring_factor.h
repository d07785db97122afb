#pragma once
/// \file How far four springs are from what they allow.

#include "cloth_sim/solver/spring_laws.h"
#include "lanes.h"

namespace cloth_sim {

/// From end a to end b of four springs.
struct FourOffsets {
  Lanes x, y, z;
};

struct FourLaws {
  Lanes rest, alpha;
  Lanes lag;  ///< only where there are dashpots
};

/// The laws of four springs; `lag` is not looked at unless there are dashpots.
template <bool kDamped>
[[gnu::always_inline]] inline FourLaws fourLawsAt(const double* rest, const double* alpha,
                                                  const double* lag) {
  FourLaws laws;
  laws.rest = lanesAt(rest);
  laws.alpha = lanesAt(alpha);
  if (kDamped) laws.lag = lanesAt(lag);
  return laws;
}

/// The corrections over the offsets [kg]. Times the inverse mass of an end and the offset it is
/// what that end moves by. \param w      of both ends together. \param start  offsets at the start
/// of the substep; only where there are dashpots.
template <bool kDamped>
[[gnu::always_inline]] inline Lanes factorsOf(const FourOffsets& d, const Lanes& w,
                                              const FourLaws& law, const FourOffsets& start) {
  const Lanes squared = d.x * d.x + d.y * d.y + d.z * d.z + kTinySquare;
  const Lanes length = sqrt(squared);
  if constexpr (kDamped) {
    const Lanes moved = (squared - d.x * start.x - d.y * start.y - d.z * start.z) / length;
    return (length - law.rest + law.lag * moved) / (length * ((1.0 + law.lag) * w + law.alpha));
  } else {
    return (length - law.rest) / (length * (w + law.alpha));
  }
}

}  // namespace cloth_sim
