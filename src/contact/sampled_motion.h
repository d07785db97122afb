#pragma once
/// \file The motion that vertices have in common, which brings nothing together.

#include <algorithm>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// Mean displacement of some of the vertices, evenly spread over all [m]; zero without any. Any
/// vector would do for what all have in common, so a sample suffices.
/// \param vertices  their number.
/// \param motionOf  displacement of a vertex [m].
template <typename MotionOf>
Vec3 sampledMotion(std::size_t vertices, const MotionOf& motionOf) {
  constexpr std::size_t kSample = 256;
  const auto stride = static_cast<VertexId>(std::max<std::size_t>(1, vertices / kSample));
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (VertexId v = 0; v < static_cast<VertexId>(vertices); v += stride, ++count)
    sum += motionOf(v);
  return sum / static_cast<double>(std::max(1, count));
}

}  // namespace cloth_sim
