// A step allocates nothing once warm: every method, with pins, a clamp, contact and armed tearing.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/parallel.h"
#include "cloth_sim/sim/simulation.h"

namespace {

std::atomic<long> allocations{0};

void* allocate(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size); }
void* operator new[](std::size_t size) { return allocate(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace cloth_sim {
namespace {

class Allocation : public testing::TestWithParam<std::string> {};

/// A step that all methods bear; it falls on a ball, held by a pin and a clamp.
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

TEST_P(Allocation, AStepAllocatesNothingOnceWarm) {
  const ThreadLimit oneThread(1);
  Simulation simulation(
      parseScene(kScene, "scene", {"solver.method=" + GetParam(), "solver.dt=0.0002"}));
  // Until the clamp has closed.
  for (int k = 0; k < 150; ++k) simulation.step();
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  const long before = allocations;
  for (int k = 0; k < 20; ++k) simulation.step();
  EXPECT_EQ(allocations - before, 0);
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_FALSE(simulation.contacts().empty());
  EXPECT_FALSE(simulation.clamps().front().held().empty());
}

std::vector<std::string> methods() {
  std::vector<std::string> names;
  for (const SolverInfo& info : solverRegistry()) names.push_back(info.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Registry, Allocation, testing::ValuesIn(methods()),
                         [](const auto& of) { return of.param; });

/// The counter counts.
TEST(Counter, SeesAnAllocation) {
  const long before = allocations;
  delete new int(1);
  EXPECT_EQ(allocations - before, 1);
}

}  // namespace
}  // namespace cloth_sim
