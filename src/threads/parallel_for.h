#pragma once
/// \file Parallel loops whose result does not depend on the number of threads.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "cloth_sim/threads/thread_pool.h"

namespace cloth_sim {

/// Calls `body(first, last)` on consecutive parts of [0, count) that together cover it, shared with
/// the ThreadPool of this thread, if there is one. Parts have at least `grain` items; a count below
/// two grains runs in the calling thread at no cost. `body` must not throw and must write nothing
/// that another part reads.
template <typename Body>
void parallelFor(std::int32_t count, std::int32_t grain, const Body& body) {
  /// So that who comes late, or has the slower core, finds some left to take.
  constexpr std::int32_t kPartsPerMember = 4;
  ThreadPool* const pool = count < 2 * grain ? nullptr : ThreadPool::ofThisThread();
  if (pool == nullptr) {
    if (count > 0) body(0, count);
    return;
  }
  struct Loop {
    const Body& body;
    std::int64_t count;
    std::int64_t parts;
    std::int32_t boundary(std::int64_t part) const {
      return static_cast<std::int32_t>(count * part / parts);
    }
  };
  const std::int32_t parts = std::min(count / grain, kPartsPerMember * pool->size());
  const Loop loop{body, count, parts};
  pool->run(
      parts,
      [](const void* context, std::int32_t part) {
        const Loop& shared = *static_cast<const Loop*>(context);
        shared.body(shared.boundary(part), shared.boundary(part + 1));
      },
      &loop);
}

/// Calls `body(part)` for each part of `order`, shared with `pool`: ThreadPool::run.
template <typename Body>
void parallelInOrder(ThreadPool& pool, const TaskGraph& order, const Body& body) {
  pool.run(
      order,
      [](const void* context, std::int32_t part) { (*static_cast<const Body*>(context))(part); },
      &body);
}

/// Calls `body(k)` for each k in [0, count), each of which is worth a thread of its own.
template <typename Body>
void parallelForEach(std::size_t count, const Body& body) {
  parallelFor(static_cast<std::int32_t>(count), 1, [&](std::int32_t first, std::int32_t last) {
    for (std::int32_t k = first; k < last; ++k) body(static_cast<std::size_t>(k));
  });
}

}  // namespace cloth_sim
