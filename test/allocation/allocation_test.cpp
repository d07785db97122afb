/// \file After the first steps, a step allocates no memory: with every method, with pins, a clamp,
/// contact and tearing enabled.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "cloth_sim/threads/thread_limit.h"

namespace {

std::atomic<long> allocations{0};

/// \return null if there is no memory.
void* tryToAllocate(std::size_t size) noexcept {
  ++allocations;
  return std::malloc(size > 0 ? size : 1);
}

void* allocate(std::size_t size) {
  if (void* memory = tryToAllocate(size)) return memory;
  throw std::bad_alloc();
}

void* allocate(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto line = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(line, (size / line + 1) * line)) return memory;
  throw std::bad_alloc();
}

}  // namespace

// Where the compiler inlines only one of the two, it takes free() for a mistake.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, alignment);
}
void* operator new(std::size_t size) { return allocate(size); }
void* operator new[](std::size_t size) { return allocate(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return tryToAllocate(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return tryToAllocate(size);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace cloth_sim {
namespace {

class Allocation : public testing::TestWithParam<std::string> {};

/// A cloth that falls on a ball, held by a pin and a clamp. All methods are stable at its step.
const char* const kScene = R"(
cloth:
  particles: [24, 24]
  size: [0.5, 0.5]
  pose: {position: [0, 0, 0.2505]}
  fabric: {preset: silk}
  pins: [corner_00]
drag: 1.0
obstacles:
  ball: {type: sphere, radius: 0.15, position: [0, 0, 0.1], friction: 0.3}
clamps:
  hand: {patch: {particle: [22, 12], radius: 2}, gap_open: 0.1, gap_closed: 0.02, closing_speed: 5.0}
tearing: {enabled: true, ratio: 100.0}
phases: [{name: all, timeout: 100.0, clamps: {hand: {grasp: true}}}]
)";

/// A cloth like this one, held by a pin only, and a smaller cloth on the same ball.
const char* const kTwoCloths = R"(
cloth:
  - {name: sheet, particles: [24, 24], size: [0.5, 0.5], pose: {position: [0, 0, 0.2505]},
     fabric: {preset: silk}, pins: [corner_00]}
  - {name: scrap, particles: [9, 9], size: [0.2, 0.2], pose: {position: [0.02, 0, 0.251]},
     fabric: {preset: silk}}
drag: 1.0
obstacles:
  ball: {type: sphere, radius: 0.15, position: [0, 0, 0.1], friction: 0.3}
self_contact: false
phases: [{name: all, timeout: 100.0}]
)";

/// A cloth on a turning sheet of triangles, of a file in the scenes.
const char* const kOnMesh = R"(
cloth:
  particles: [24, 24]
  size: [0.3, 0.3]
  pose: {position: [0.1, 0, 0.002]}
  fabric: {preset: silk}
drag: 1.0
obstacles:
  flap: {type: mesh, file: flap.obj, friction: 0.3, angular_velocity: [0, -0.2, 0]}
phases: [{name: all, timeout: 100.0}]
)";

/// The number of allocations in `steps` steps, after `warmUp` steps.
long allocationsOf(Simulation& simulation, int warmUp, int steps) {
  for (int k = 0; k < warmUp; ++k) simulation.step();
  const long before = allocations;
  for (int k = 0; k < steps; ++k) simulation.step();
  return allocations - before;
}

Simulation simulationOf(const char* scene, const std::string& method) {
  return Simulation(parseScene(scene, "scene", {"solver.method=" + method, "solver.dt=0.0002"}));
}

TEST_P(Allocation, AStepAllocatesNothingOnceWarm) {
  const ThreadLimit oneThread(1);
  Simulation simulation = simulationOf(kScene, GetParam());
  EXPECT_EQ(allocationsOf(simulation, 150, 20), 0);  // the clamp closes in the first 80
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_FALSE(simulation.contacts().empty());
  EXPECT_FALSE(simulation.clamps().front().held().empty());
}

TEST_P(Allocation, AStepOfTwoClothsOnOneBallAllocatesNothing) {
  const ThreadLimit oneThread(1);
  Simulation simulation = simulationOf(kTwoCloths, GetParam());
  EXPECT_EQ(allocationsOf(simulation, 150, 20), 0);
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_EQ(simulation.contacts().candidates.size(), 2U);
}

TEST_P(Allocation, AStepOnAMeshAllocatesNothing) {
  const ThreadLimit oneThread(1);
  const std::string name = std::string(CLOTH_SIM_SOURCE_DIR) + "/config/scenes/scene.yaml";
  Simulation simulation(
      parseScene(kOnMesh, name, {"solver.method=" + GetParam(), "solver.dt=0.0002"}));
  EXPECT_EQ(allocationsOf(simulation, 150, 20), 0);
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_FALSE(simulation.contacts().empty());
}

TEST_P(Allocation, AStepWithFrictionInBendingAllocatesNothing) {
  if (!findSolver(GetParam()).hasBendFriction) GTEST_SKIP() << "refuses it";
  const ThreadLimit oneThread(1);
  Simulation simulation(parseScene(kScene, "scene",
                                   {"solver.method=" + GetParam(), "solver.dt=0.0002",
                                    "cloth.fabric.bending_hysteresis=1.0e-4"}));
  EXPECT_EQ(allocationsOf(simulation, 150, 20), 0);
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_FALSE(simulation.state().bendOffset.empty());
}

TEST(AllocationErrorControl, AChangeOfSubstepsAllocatesNothing) {
  const ThreadLimit oneThread(1);
  Simulation simulation(parseScene(R"(
cloth: {particles: [24, 24], size: [0.5, 0.5], fabric: {preset: silk}, pins: [corner_00]}
solver: {error: 0.002, budget: 300}
phases: [{name: swing, timeout: 100.0}]
)",
                                   "swing.yaml"));
  for (int k = 0; k < 12; ++k) simulation.step();
  int least = simulation.lastReport().substeps, most = least;
  const long before = allocations;
  for (int k = 0; k < 60; ++k) {
    simulation.step();
    least = std::min(least, simulation.lastReport().substeps);
    most = std::max(most, simulation.lastReport().substeps);
  }
  EXPECT_EQ(allocations - before, 0);
  EXPECT_LT(least, most) << "substeps have not changed";
}

TEST(AllocationLayers, AStepOfClothsOnEachOtherAllocatesNothingOnceTheyLieStill) {
  const ThreadLimit oneThread(1);
  Simulation simulation(parseScene(R"(
cloth:
  - {name: lower, particles: [13, 13], size: [0.1, 0.1], pose: {position: [0, 0, 0.001]},
     fabric: cotton}
  - {name: upper, particles: [13, 13], size: [0.1, 0.1], pose: {position: [0.01, 0, 0.003]},
     fabric: cotton}
solver: {method: line_xpbd, substeps: 20, dt: 0.016666666666666666, sleep: false}
drag: 1
obstacles: {table: {type: plane}}
phases: [{name: all, timeout: 100.0}]
)",
                                   "layers.yaml"));
  EXPECT_EQ(allocationsOf(simulation, 60, 20), 0);
  EXPECT_GT(simulation.layerReport()->contacts, 20);
}

TEST(AllocationAsleep, AStepAsleepAllocatesNothing) {
  const ThreadLimit oneThread(1);
  Simulation simulation(parseScene(kScene, "scene", {"drag=50", "solver.sleep.speed=0.01"}));
  for (int k = 0; k < 1000 && !simulation.isAsleep(); ++k) simulation.step();
  ASSERT_TRUE(simulation.isAsleep());
  EXPECT_EQ(allocationsOf(simulation, 1, 20), 0);
  EXPECT_TRUE(simulation.isAsleep());
}

std::vector<std::string> methods() {
  std::vector<std::string> names;
  for (const SolverInfo& info : solverRegistry()) names.push_back(info.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Registry, Allocation, testing::ValuesIn(methods()),
                         [](const auto& of) { return of.param; });

/// Checks that the counter counts.
TEST(Counter, SeesAnAllocation) {
  const long before = allocations;
  int* volatile made = new int(1);  // volatile: a compiler may leave out a pair of new and delete
  delete made;
  // NOLINTNEXTLINE(clang-analyzer-unix.Malloc): the operator above deletes what this one made.
  EXPECT_EQ(allocations - before, 1);
}

}  // namespace
}  // namespace cloth_sim
