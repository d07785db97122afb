/// \file The same scene and commands give the same bits: twice, at any number of threads, watched
/// or not, after a reset.

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <set>
#include <thread>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/parallel.h"
#include "cloth_sim/sim/simulation.h"
#include "cloth_sim/solver/packed_particles.h"
#include "cloth_sim/solver/parallel_for.h"
#include "cloth_sim/solver/spring_schedule.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

/// A cloth that falls on a sphere over a table, is notched, grasped and torn, refined where it
/// tears.
Scene busyScene(const std::string& method, int n = 64) {
  const bool limited = std::isfinite(findSolver(method).stabilityLimit);
  const std::string substeps = limited ? "50" : "2";
  const std::string last = std::to_string(n - 3);
  const std::string half = std::to_string(n / 2);
  const std::string bending = findSolver(method).followsFabric ? "hinge" : "springs";
  return parseScene(R"(
seed: 3
cloth:
  size: [1, 1]
  particles: [)" + std::to_string(n) +
                        ", " + std::to_string(n) + R"(]
  pose: {position: [0, 0, 0.21]}
  random_offset: 0.01
  velocity: [0, 0, -1]
  fabric: {preset: interlock, damping: 1.0e-5}
  bending: )" + bending +
                        R"(
solver: {method: )" + method +
                        R"(, dt: 0.0166666666666666667, substeps: )" + substeps +
                        R"(}
drag: 1.0
wind: {velocity: [1, 0, 0]}
obstacles:
  table: {type: board, size: [1.6, 1.6, 0.05], position: [0, 0, -0.025]}
  sphere: {type: sphere, radius: 0.1, position: [0, 0, 0.1]}
clamps:
  left: {patch: {particle: [2, )" +
                        half + R"(], radius: 3}, closing_speed: 3.0}
  right: {patch: {particle: [)" +
                        last + ", " + half + R"(], radius: 3}, closing_speed: 3.0}
tearing: {ratio: 1.2, seam: {path: [[0.5, 0], [0.5, 1]]}}
phases:
  - {name: fall, notch: [[0.5, 0], [0.5, 0.2]], timeout: 0.08}
  - {name: close, clamps: {all: {grasp: true}}, timeout: 0.08}
  - name: pull
    clamps: {left: {move_by: [-1, 0, 0.2], speed: 2.0}, right: {move_by: [1, 0, 0.2], speed: 2.0}}
    timeout: 10.0
)",
                    "busy.yaml");
}

std::uint64_t hashOf(const Simulation& simulation) {
  return stateHash(simulation.model(), simulation.state());
}

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
  const Model model = buildModel(busyScene(GetParam()).cloth);
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
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
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

}  // namespace
}  // namespace cloth_sim
