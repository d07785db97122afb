/// \file The same scene and commands give the same bits in every run, at any number of threads,
/// with and without observers, and after a reset.

#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <vector>

#include "cloth_sim/threads/thread_limit.h"
#include "cloth_sim/threads/thread_pool.h"
#include "determinism/busy_scene.h"
#include "fewer_cases.h"
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
  std::set<std::uint64_t> hashes;
  std::set<int> broken;
  const bool areAll = casesForOne() == 1;
  for (const int threads : areAll ? std::vector<int>{1, 2, 4, 2} : std::vector<int>{1, 2}) {
    const ThreadLimit limit(threads);
    ThreadPool pool;
    // The simulation's own regions have no effect inside this one, so its loops run on this pool.
    const ThreadPool::ParallelRegion region(pool);
    // A loop does not wait for a worker that the machine does not run: on a busy machine, the run
    // is repeated until a worker has taken part.
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    do {
      Simulation simulation(busyScene(GetParam()));
      run(simulation, kSteps);
      hashes.insert(hashOf(simulation));
      broken.insert(simulation.broken().total);
    } while (threads > 1 && pool.workerTasks() == 0 && std::chrono::steady_clock::now() < deadline);
    EXPECT_EQ(pool.workerTasks() > 0, threads > 1) << threads << " threads";
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
  for (const int steps : {0, 7}) {  // at the end of a run, and some steps later
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
    EXPECT_TRUE(simulation.apply(RefineMesh{{{Vec3(0.2, 0.2, 0.2)}, {0.1, 2, 0.0}}}).success);
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

}  // namespace
}  // namespace cloth_sim
