/// \file Parallel loops do everything once, with helpers or without.

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
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
    const ThreadPool::ParallelRegion shift(pool);
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

TEST(ParallelFor, RunsInTheCallingThreadOutsideOfAShift) {
  const ThreadLimit limit(2);
  const std::thread::id here = std::this_thread::get_id();
  std::vector<std::thread::id> by(1000);
  parallelFor(1000, 10, [&](std::int32_t first, std::int32_t last) {
    std::fill(by.begin() + first, by.begin() + last, std::this_thread::get_id());
  });
  EXPECT_EQ(std::count(by.begin(), by.end(), here), 1000);
}

TEST(ParallelFor, InAnotherOneIsNotShared) {
  const ThreadLimit limit(2);
  ThreadPool pool;
  const ThreadPool::ParallelRegion shift(pool);
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

/// Polled: a helper comes when the machine lets it.
TEST(ThreadPool, HelpersComeAndTakeParts) {
  const ThreadLimit limit(2);
  ThreadPool pool;
  const std::thread::id here = std::this_thread::get_id();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  std::atomic<bool> helped{false};
  for (int shifts = 0; shifts < 3; ++shifts) {  // ... in each shift
    const ThreadPool::ParallelRegion shift(pool);
    helped = false;
    while (!helped && std::chrono::steady_clock::now() < deadline) {
      parallelFor(8, 1, [&](std::int32_t, std::int32_t) {
        if (std::this_thread::get_id() != here) helped = true;
      });
    }
    EXPECT_TRUE(helped);
  }
}

/// Loops follow each other at once, so that helpers meet the end of one and the beginning of the
/// next at any moment.
TEST(ThreadPool, ManyShortLoopsLoseNoPart) {
  for (const int threads : {2, 3}) {
    const ThreadLimit limit(threads);
    ThreadPool pool;
    std::vector<std::int64_t> sums(16, 0);
    constexpr std::int64_t kLoops = 20000;
    for (std::int64_t loop = 0; loop < kLoops; ++loop) {
      if (loop % 100 == 0) std::this_thread::yield();
      const ThreadPool::ParallelRegion shift(pool);
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

/// Groups of parts, each of which waits for some of earlier groups.
TaskGraph someOrder() {
  TaskGraph order;
  std::uint32_t random = 1;
  std::int32_t part = 0;
  for (const std::int32_t parts : {5, 1, 8, 2, 2, 16}) {
    const std::int32_t first = part;
    for (; part < first + parts; ++part) {
      for (std::int32_t earlier = 0; earlier < first; ++earlier) {
        random = 1664525U * random + 1013904223U;
        if (random >> 30 == 0) order.waits.push_back(earlier);
      }
      order.waitEnds.push_back(static_cast<std::int32_t>(order.waits.size()));
    }
    order.groupEnds.push_back(part);
  }
  return order;
}

TEST(ThreadPool, DoesEveryPartOnceAndAfterThoseItWaitsFor) {
  const TaskGraph order = someOrder();
  const auto parts = static_cast<std::size_t>(order.groupEnds.back());
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    ThreadPool pool;
    for (int shift = 0; shift < 200; ++shift) {
      const ThreadPool::ParallelRegion now(pool);
      for (std::int64_t loop = 1; loop <= 20; ++loop) {
        // Not atomic: a part that does not wait is a data race.
        std::vector<std::int64_t> done(parts, 0);
        std::atomic<int> early{0};
        parallelInOrder(pool, order, [&](std::int32_t part) {
          const std::int32_t begin = part == 0 ? 0 : order.waitEnds[part - 1];
          for (std::int32_t k = begin; k < order.waitEnds[part]; ++k) {
            if (done[order.waits[k]] != 1) ++early;
          }
          ++done[part];
        });
        ASSERT_EQ(early.load(), 0);
        ASSERT_EQ(std::count(done.begin(), done.end(), 1), static_cast<std::int64_t>(parts));
      }
    }
  }
}

TEST(ThreadLimit, HoldsForItsThreadWhileItLives) {
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

TEST(ThreadLimit, OfNoneIsOnePerProcessor) {
  const ThreadLimit outer(3);
  const ThreadLimit inner(0);
  EXPECT_EQ(ThreadLimit::ofThisThread(), processors());
}

}  // namespace
}  // namespace cloth_sim
