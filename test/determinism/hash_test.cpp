/// \file The same scene and commands give the same bits: twice, at any number of threads, watched
/// or not, after a reset.

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <thread>

#include "cloth_sim/solver/packed_particles.h"
#include "cloth_sim/solver/spring_schedule.h"
#include "cloth_sim/threads/parallel_for.h"
#include "cloth_sim/threads/thread_limit.h"
#include "determinism/busy_scene.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using testing_support::busyScene;
using testing_support::hashOf;

constexpr int kSteps = 24;

void run(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.step();
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
}

class Determinism : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Registry, Determinism,
                         testing::ValuesIn(testing_support::boundedSolverNames()),
                         [](const auto& test) { return test.param; });

TEST_P(Determinism, OneThreadOrTwoOrFour) {
  // 64 x 64 has enough springs for more than one strand of 2048, so that sweeps split over threads.
  const Model model = buildModel(busyScene(GetParam()).cloths[0]);
  PackedParticles particles;
  particles.layOut(model);
  SpringSchedule schedule;
  schedule.build(model, particles.slotOf);
  int parts = 0;
  for (const SpringSchedule::Batch& batch : schedule.batches()) {
    const int strands = batch.endStrand - batch.firstStrand;
    if (batch.springs >= 2048 * strands) parts = std::max(parts, strands);
  }
  ASSERT_GE(parts, 2) << "the scene has too few springs to split";

  std::set<std::uint64_t> hashes;
  std::set<int> broken;
  for (const int threads : {1, 2, 4, 2}) {
    const ThreadLimit limit(threads);
    Simulation simulation(busyScene(GetParam()));
    run(simulation, kSteps);
    hashes.insert(hashOf(simulation));
    broken.insert(simulation.broken().total);
  }
  EXPECT_EQ(hashes.size(), 1U);
  EXPECT_EQ(broken.size(), 1U);
  EXPECT_GT(*broken.begin(), 0) << "the scene was to be notched";
}

TEST_P(Determinism, TwiceTheSame) {
  Simulation first(busyScene(GetParam(), 32));
  Simulation second(busyScene(GetParam(), 32));
  for (int k = 0; k < 2 * kSteps; ++k) {
    first.step();
    second.step();
    ASSERT_EQ(hashOf(first), hashOf(second)) << "step " << k;
  }
  EXPECT_GT(first.broken().torn, 0) << "the scene was to tear";
}

TEST_P(Determinism, WatchedOrNot) {
  Simulation watched(busyScene(GetParam(), 32));
  Simulation alone(busyScene(GetParam(), 32));
  for (int k = 0; k < kSteps; ++k) {
    watched.step();
    watched.snapshot();
    watched.observeMaxStretch();
    watched.takeEvents();
  }
  run(alone, kSteps);
  EXPECT_EQ(hashOf(watched), hashOf(alone));
}

TEST_P(Determinism, AfterAReset) {
  Simulation simulation(busyScene(GetParam(), 32));
  run(simulation, kSteps);
  const std::uint64_t first = hashOf(simulation);
  for (const int steps : {0, 7}) {  // right away, and again in the middle of things
    run(simulation, steps);
    ASSERT_TRUE(simulation.apply(SetGravity{Vec3(1.0, 0.0, 0.0)}).success);
    ASSERT_TRUE(simulation.apply(Reset{}).success);
    run(simulation, kSteps);
    EXPECT_EQ(hashOf(simulation), first);
  }
}

TEST_P(Determinism, CommandsAtTheSameTimes) {
  const auto commanded = [&] {
    Simulation simulation(busyScene(GetParam(), 32));
    run(simulation, 3);
    simulation.apply(SetGrasp{"left", true});
    run(simulation, 5);
    simulation.apply(MoveObstacle{"sphere", Pose{Vec3(0.1, 0.0, 0.1)}, Vec3(0.0, 0.5, 0.0)});
    simulation.apply(SetPhase{"pull"});
    run(simulation, 4);
    const Vec3 down(0.0, 0.0, -1.0);
    EXPECT_TRUE(simulation.apply(RefineNear{{Vec3(0.2, 0.2, 0.2)}, {0.1, 2, 0.0}}).success);
    EXPECT_TRUE(
        simulation.apply(CutAlong{strokeAlong({{-1, 0.13, 0}, {1, 0.27, 0}}, down, 1.0)}).success);
    run(simulation, 6);
    return hashOf(simulation);
  };
  const std::uint64_t first = commanded();
  EXPECT_EQ(commanded(), first);
  Simulation uncommanded(busyScene(GetParam(), 32));
  run(uncommanded, 18);
  EXPECT_NE(hashOf(uncommanded), first);
}

TEST(Determinism, TheSeedMakesADifference) {
  Scene other = busyScene("xpbd", 32);
  other.seed = 4;
  Simulation first(busyScene("xpbd", 32));
  Simulation second(other);
  run(first, 2);
  run(second, 2);
  EXPECT_NE(hashOf(first), hashOf(second));
}

TEST(ParallelFor, CoversEveryItemOnceAndInOneThreadIfLimited) {
  Team team;
  for (const int threads : {1, 2, 3, 1, 2}) {
    const ThreadLimit limit(threads);
    const Team::Shift shift(team);
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
  Team team;
  const Team::Shift shift(team);
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
TEST(Team, HelpersComeAndTakeParts) {
  const ThreadLimit limit(2);
  Team team;
  const std::thread::id here = std::this_thread::get_id();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  std::atomic<bool> helped{false};
  for (int shifts = 0; shifts < 3; ++shifts) {  // ... in each shift
    const Team::Shift shift(team);
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
TEST(Team, ManyShortLoopsLoseNoPart) {
  for (const int threads : {2, 3}) {
    const ThreadLimit limit(threads);
    Team team;
    std::vector<std::int64_t> sums(16, 0);
    constexpr std::int64_t kLoops = 20000;
    for (std::int64_t loop = 0; loop < kLoops; ++loop) {
      if (loop % 100 == 0) std::this_thread::yield();
      const Team::Shift shift(team);
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

TEST(ThreadLimit, HoldsForItsThreadWhileItLives) {
  const int before = ThreadLimit::ofThisThread();
  EXPECT_EQ(before, ThreadLimit::processors());
  {
    const ThreadLimit outer(3);
    const ThreadLimit inner(1);
    EXPECT_EQ(ThreadLimit::ofThisThread(), 1);
    std::thread([&] { EXPECT_EQ(ThreadLimit::ofThisThread(), before); }).join();
  }
  EXPECT_EQ(ThreadLimit::ofThisThread(), before);
}

}  // namespace
}  // namespace cloth_sim
