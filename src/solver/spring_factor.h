#pragma once
/// \file How far four springs are from what they allow.

#include <algorithm>

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

/// Fewer than four springs, and the last of them again in the lanes that are left.
struct FilledFour {
  std::int32_t a[kLanes], b[kLanes];
  double rest[kLanes], alpha[kLanes], lag[kLanes];
};

/// \param springs  pointers to what `FilledFour` has, of the first spring.
/// \param count    1 to 3
template <bool kDamped, typename Springs>
[[gnu::always_inline]] inline FilledFour filledFour(const Springs& springs, std::int32_t count) {
  FilledFour four;
  for (std::int32_t lane = 0; lane < kLanes; ++lane) {
    const std::int32_t k = std::min(lane, count - 1);
    four.a[lane] = springs.a[k];
    four.b[lane] = springs.b[k];
    four.rest[lane] = springs.rest[k];
    four.alpha[lane] = springs.alpha[k];
    if (kDamped) four.lag[lane] = springs.lag[k];
  }
  return four;
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
