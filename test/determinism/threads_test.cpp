/// \file Parallel loops run every task once, with worker threads or without.

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "cloth_sim/threads/thread_limit.h"
#include "cloth_sim/threads/thread_pool.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

int processors() {
  cpu_set_t allowed;
  return sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? CPU_COUNT(&allowed) : 1;
}

TEST(ParallelFor, CoversEveryItemOnceAndInOneThreadIfLimited) {
  ThreadPool pool;
  for (const int threads : {1, 2, 3, 1, 2}) {
    const ThreadLimit limit(threads);
    const ThreadPool::ParallelRegion region(pool);
    ASSERT_EQ(ThreadPool::ofThisThread(), threads == 1 ? nullptr : &pool);
    ASSERT_EQ(pool.size(), threads);
    for (const std::int32_t count : {0, 1, 63, 64, 128, 1000}) {
      std::vector<std::atomic<int>> visits(static_cast<std::size_t>(count));
      std::atomic<bool> elsewhere{false};
      const std::thread::id here = std::this_thread::get_id();
      parallelFor(count, 32, [&](std::int32_t first, std::int32_t last) {
        if (std::this_thread::get_id() != here) elsewhere = true;
        for (std::int32_t k = first; k < last; ++k) ++visits[k];
      });
      for (const auto& n : visits) EXPECT_EQ(n.load(), 1);
      EXPECT_FALSE(elsewhere && (threads == 1 || count < 64));
    }
  }
}

TEST(ParallelFor, RunsInTheCallingThreadOutsideOfARegion) {
  const ThreadLimit limit(2);
  const std::thread::id here = std::this_thread::get_id();
  std::vector<std::thread::id> by(1000);
  parallelFor(1000, 10, [&](std::int32_t first, std::int32_t last) {
    std::fill(by.begin() + first, by.begin() + last, std::this_thread::get_id());
  });
  EXPECT_EQ(std::count(by.begin(), by.end(), here), 1000);
}

TEST(ParallelFor, InsideOfATaskRunsInItsThread) {
  const ThreadLimit limit(2);
  ThreadPool pool;
  const ThreadPool::ParallelRegion region(pool);
  std::vector<std::atomic<int>> visits(64 * 64);
  parallelFor(64, 1, [&](std::int32_t first, std::int32_t last) {
    for (std::int32_t j = first; j < last; ++j) {
      parallelFor(64, 1, [&](std::int32_t begin, std::int32_t end) {
        for (std::int32_t k = begin; k < end; ++k) ++visits[64 * j + k];
      });
    }
  });
  for (const auto& n : visits) EXPECT_EQ(n.load(), 1);
}

/// Calls `loop` until it has returned true `times` times, for 20 s at most.
/// \return how often it has; worker threads take part when the machine lets them
template <typename Loop>
int repeatUntilShared(int times, const Loop& loop) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  int shared = 0;
  while (shared < times && std::chrono::steady_clock::now() < deadline) shared += loop() ? 1 : 0;
  return shared;
}

TEST(ThreadPool, WorkersTakePartInEveryRegion) {
  const ThreadLimit limit(2);
  ThreadPool pool;
  const std::thread::id here = std::this_thread::get_id();
  std::atomic<bool> isShared{false};
  for (int repeat = 0; repeat < 3; ++repeat) {
    const ThreadPool::ParallelRegion region(pool);
    const auto loop = [&] {
      isShared = false;
      parallelFor(8, 1, [&](std::int32_t, std::int32_t) {
        if (std::this_thread::get_id() != here) isShared = true;
      });
      return isShared.load();
    };
    ASSERT_EQ(repeatUntilShared(1, loop), 1);
  }
}

constexpr std::chrono::milliseconds kLongTask{1};

/// A task in a worker thread takes long, those in the calling thread do not: a loop that did not
/// wait for the worker would return before its task is complete.
TEST(ThreadPool, LoopsReturnAfterTheTasksOfWorkers) {
  const ThreadLimit limit(2);
  ThreadPool pool;
  const std::thread::id here = std::this_thread::get_id();
  std::atomic<int> complete{0};
  std::atomic<bool> isShared{false};
  const ThreadPool::ParallelRegion region(pool);
  const auto loop = [&] {
    complete = 0;
    isShared = false;
    parallelFor(8, 1, [&](std::int32_t first, std::int32_t last) {
      if (std::this_thread::get_id() != here) {
        isShared = true;
        std::this_thread::sleep_for(kLongTask);
      }
      complete += last - first;
    });
    EXPECT_EQ(complete.load(), 8);
    return isShared.load();
  };
  EXPECT_EQ(repeatUntilShared(5, loop), 5);
}

/// Tasks 0 and 2 are those of the calling thread, 1 and 3 those of the worker. Task 1 takes long,
/// so the calling thread tries to steal task 3, which depends on task 1. It has to wait, and then
/// only one of the two threads may run task 3.
TEST(ThreadPool, WaitsForPredecessorsInWorkers) {
  const ThreadLimit limit(2);
  ThreadPool pool;
  TaskGraph graph;
  graph.groupEnds = {2, 4};
  graph.predecessorEnds = {0, 0, 1, 3};
  graph.predecessors = {0, 0, 1};
  const std::thread::id here = std::this_thread::get_id();
  std::array<std::atomic<int>, 4> runs{};
  std::atomic<bool> isShared{false};
  std::atomic<int> early{0};
  const ThreadPool::ParallelRegion region(pool);
  const auto loop = [&] {
    for (std::atomic<int>& n : runs) n = 0;
    isShared = false;
    parallelInOrder(pool, graph, [&](std::int32_t task) {
      if (task == 3 && (runs[0] == 0 || runs[1] == 0)) ++early;
      if (task == 1 && std::this_thread::get_id() != here) {
        isShared = true;
        std::this_thread::sleep_for(kLongTask);
      }
      ++runs[static_cast<std::size_t>(task)];
    });
    for (const std::atomic<int>& n : runs) EXPECT_EQ(n.load(), 1);
    return isShared.load();
  };
  EXPECT_EQ(repeatUntilShared(5, loop), 5);
  EXPECT_EQ(early.load(), 0);
}

/// Loops follow each other at once, so that worker threads come to the end of one and the beginning
/// of the next at any moment.
TEST(ThreadPool, ManyShortLoopsLoseNoTask) {
  for (const int threads : {2, 3}) {
    const ThreadLimit limit(threads);
    ThreadPool pool;
    std::vector<std::int64_t> sums(16, 0);
    constexpr std::int64_t kLoops = 20000;
    for (std::int64_t loop = 0; loop < kLoops; ++loop) {
      if (loop % 100 == 0) std::this_thread::yield();
      const ThreadPool::ParallelRegion region(pool);
      for (int again = 0; again < 3; ++again) {
        parallelFor(16, 1, [&](std::int32_t first, std::int32_t last) {
          for (std::int32_t k = first; k < last; ++k) sums[k] += loop + k;
        });
      }
    }
    for (std::int64_t k = 0; k < 16; ++k) {
      EXPECT_EQ(sums[k], 3 * (kLoops * (kLoops - 1) / 2 + k * kLoops));
    }
  }
}

/// Groups of tasks, each of which depends on about a quarter of the tasks of earlier groups.
TaskGraph randomGraph() {
  TaskGraph graph;
  std::uint32_t random = 1;
  std::int32_t task = 0;
  for (const std::int32_t tasks : {5, 1, 8, 2, 2, 16}) {
    const std::int32_t first = task;
    for (; task < first + tasks; ++task) {
      for (std::int32_t earlier = 0; earlier < first; ++earlier) {
        random = 1664525U * random + 1013904223U;
        if (random >> 30 == 0) graph.predecessors.push_back(earlier);
      }
      graph.predecessorEnds.push_back(static_cast<std::int32_t>(graph.predecessors.size()));
    }
    graph.groupEnds.push_back(task);
  }
  return graph;
}

TEST(ThreadPool, RunsEveryTaskOnceAndAfterItsPredecessors) {
  const TaskGraph graph = randomGraph();
  const auto tasks = static_cast<std::size_t>(graph.groupEnds.back());
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    ThreadPool pool;
    for (int repeat = 0; repeat < 200; ++repeat) {
      const ThreadPool::ParallelRegion region(pool);
      for (int loop = 0; loop < 20; ++loop) {
        // Not atomic: a task that does not wait for its predecessors is a data race.
        std::vector<int> runs(tasks, 0);
        std::atomic<int> early{0};
        parallelInOrder(pool, graph, [&](std::int32_t task) {
          const std::int32_t begin = task == 0 ? 0 : graph.predecessorEnds[task - 1];
          for (std::int32_t k = begin; k < graph.predecessorEnds[task]; ++k) {
            if (runs[graph.predecessors[k]] != 1) ++early;
          }
          ++runs[task];
        });
        ASSERT_EQ(early.load(), 0);
        ASSERT_EQ(std::count(runs.begin(), runs.end(), 1), static_cast<std::int64_t>(tasks));
      }
    }
  }
}

TEST(ThreadLimit, HoldsForItsThreadDuringItsLifetime) {
  const int before = ThreadLimit::ofThisThread();
  EXPECT_EQ(before, processors());
  {
    const ThreadLimit outer(3);
    const ThreadLimit inner(1);
    EXPECT_EQ(ThreadLimit::ofThisThread(), 1);
    std::thread([&] { EXPECT_EQ(ThreadLimit::ofThisThread(), before); }).join();
  }
  EXPECT_EQ(ThreadLimit::ofThisThread(), before);
}

TEST(ThreadLimit, OfZeroIsOnePerProcessor) {
  const ThreadLimit outer(3);
  const ThreadLimit inner(0);
  EXPECT_EQ(ThreadLimit::ofThisThread(), processors());
}

}  // namespace
}  // namespace cloth_sim
