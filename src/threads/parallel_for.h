#pragma once
/// \file Parallel loops whose result does not depend on the number of threads.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "cloth_sim/threads/thread_pool.h"

namespace cloth_sim {

/// Calls `body(first, last)` for consecutive chunks [first, last) that cover [0, count), on the
/// threads of the current ThreadPool::ParallelRegion. Outside of a region, and if count is less
/// than two grains, there is one chunk, in the calling thread.
/// \param grain  smallest size of a chunk
/// \param body   must not throw and must not write what another chunk reads or writes
template <typename Body>
void parallelFor(std::int32_t count, std::int32_t grain, const Body& body) {
  /// More than one, so that the other threads can steal from a late or slow one.
  constexpr std::int32_t kChunksPerThread = 4;
  ThreadPool* const pool = count < 2 * grain ? nullptr : ThreadPool::ofThisThread();
  if (pool == nullptr) {
    if (count > 0) body(0, count);
    return;
  }
  struct Loop {
    const Body& body;
    std::int64_t count;
    std::int64_t chunks;
    std::int32_t boundary(std::int64_t chunk) const {
      return static_cast<std::int32_t>(count * chunk / chunks);
    }
  };
  const std::int32_t threads = pool->size();
  const std::int32_t most = std::min(count / grain, kChunksPerThread * threads);
  const std::int32_t chunks = most > threads ? most - most % threads : most;  // as many for each
  const Loop loop{body, count, chunks};
  pool->run(
      chunks,
      [](const void* context, std::int32_t chunk) {
        const Loop& shared = *static_cast<const Loop*>(context);
        shared.body(shared.boundary(chunk), shared.boundary(chunk + 1));
      },
      &loop);
}

/// Calls `body(task)` for each task of the graph, after its predecessors; see ThreadPool::run.
template <typename Body>
void parallelInOrder(ThreadPool& pool, const TaskGraph& graph, const Body& body) {
  pool.run(
      graph,
      [](const void* context, std::int32_t task) { (*static_cast<const Body*>(context))(task); },
      &body);
}

/// Calls `body(k)` for each k in [0, count), in chunks of at least `grain`.
template <typename Body>
void parallelForEach(std::size_t count, std::int32_t grain, const Body& body) {
  parallelFor(static_cast<std::int32_t>(count), grain, [&](std::int32_t first, std::int32_t last) {
    for (std::int32_t k = first; k < last; ++k) body(k);
  });
}

/// Calls `body(k)` for each k in [0, count); every call is worth a thread of its own.
template <typename Body>
void parallelForEach(std::size_t count, const Body& body) {
  parallelForEach(count, 1, [&](std::int32_t k) { body(static_cast<std::size_t>(k)); });
}

}  // namespace cloth_sim
