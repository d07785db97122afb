#pragma once
/// \file Parallel loops whose result does not depend on the number of threads.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>
#include <cstdint>

namespace cloth_sim {

/// Calls `body(first, last)` on consecutive parts of [0, count) that together cover it, on as many
/// threads as ThreadLimit allows. Parts have at least `grain` items; a count below two grains runs
/// in the calling thread at no cost. `body` must write nothing that another part reads.
template <typename Body>
void parallelFor(std::int32_t count, std::int32_t grain, const Body& body) {
  if (count < 2 * grain) {
    if (count > 0) body(0, count);
    return;
  }
  tbb::parallel_for(
      tbb::blocked_range<std::int32_t>(0, count, static_cast<std::size_t>(grain)),
      [&](const tbb::blocked_range<std::int32_t>& part) { body(part.begin(), part.end()); },
      tbb::static_partitioner());
}

/// Calls `body(k)` for each k in [0, count), each of which is worth a thread of its own.
template <typename Body>
void parallelForEach(std::size_t count, const Body& body) {
  parallelFor(static_cast<std::int32_t>(count), 1, [&](std::int32_t first, std::int32_t last) {
    for (std::int32_t k = first; k < last; ++k) body(static_cast<std::size_t>(k));
  });
}

}  // namespace cloth_sim
