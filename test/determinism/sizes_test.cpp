/// \file One thread or two give the same bits for cloths of every size.
///
/// Loops are divided among threads in blocks, and a loop that is shorter than a block stays on one
/// thread. The sizes here are near and on both sides of every power of two from 256 to 8192
/// particles. There are about six springs and two faces to a particle, so the numbers
/// of springs, faces, and springs that a cut has moved pass the same powers at other sizes. No
/// constant of the code is named here: the test holds for any block size in that range.

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "cloth_sim/threads/thread_limit.h"
#include "cloth_sim/threads/thread_pool.h"
#include "determinism/busy_scene.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using testing_support::busyScene;
using testing_support::hashOf;

/// Particles along a side of the cloth: for every power of two, the side whose square is the last
/// below it, and the first that is not.
std::vector<int> sides() {
  std::vector<int> result;
  for (int power = 256; power <= 8192; power *= 2) {
    int side = 1;
    while (side * side < power) ++side;
    result.push_back(side - 1);
    result.push_back(side);
  }
  return result;
}

struct Outcome {
  std::uint64_t hash = 0;
  std::int64_t workerTasks = 0;  ///< tasks of parallel loops that the second thread ran
};

/// A step, a cut across the cloth, a refinement, and a step of the edited cloth.
Outcome outcomeOf(const Scene& scene, int threads) {
  const ThreadLimit limit(threads);
  ThreadPool pool;
  const ThreadPool::ParallelRegion region(pool);
  Simulation simulation(scene);
  simulation.step();
  const Vec3 down(0.0, 0.0, -1.0);
  EXPECT_TRUE(
      simulation.apply(CutAlong{strokeAlong({{-1, 0.13, 0}, {1, 0.27, 0}}, down, 1.0)}).success);
  EXPECT_TRUE(simulation.apply(RefineMesh{{{Vec3(0.2, 0.2, 0.2)}, {0.1, 1, 0.0}}}).success);
  simulation.step();
  EXPECT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_GT(simulation.broken().cut, 0);
  return {hashOf(simulation), pool.workerTasks()};
}

class Sizes : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Registry, Sizes, testing::ValuesIn(testing_support::boundedSolverNames()),
                         [](const auto& test) { return test.param; });

/// Compares a run on one thread with one on two. \return tasks that the second thread ran.
std::int64_t compareThreads(const std::string& method, int side) {
  const Scene scene = busyScene(method, side);
  const Outcome one = outcomeOf(scene, 1);
  const Outcome two = outcomeOf(scene, 2);
  EXPECT_EQ(one.hash, two.hash) << side << " x " << side << " particles";
  return two.workerTasks;
}

/// On a loaded machine the second thread may sleep through runs of a few milliseconds; then the
/// largest size runs again.
TEST_P(Sizes, OneThreadOrTwo) {
  constexpr int kMostRepeats = 200;
  std::int64_t workerTasks = 0;
  for (const int side : sides()) workerTasks += compareThreads(GetParam(), side);
  for (int k = 0; workerTasks == 0 && k < kMostRepeats; ++k) {
    workerTasks += compareThreads(GetParam(), sides().back());
  }
  EXPECT_GT(workerTasks, 0) << "the second thread ran nothing";
}

}  // namespace
}  // namespace cloth_sim
