/// \file A step that is stopped leaves cloth, clamps and time where they were, with every method.

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <utility>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

/// A cloth that a clamp carries away from a ball.
const char* const kScene = R"(
cloth:
  particles: [33, 33]
  size: [0.5, 0.5]
  pose: {position: [0, 0, 0.2]}
  fabric: silk
obstacles:
  ball: {type: sphere, radius: 0.15, position: [0, 0, 0.0]}
clamps:
  hand: {patch: {particle: [0, 0], radius: 2}, grip_force: 1000.0}
solver: {dt: 0.01}
phases: [{name: all, timeout: 100.0, clamps: {hand: {grasp: true, move_by: [0, 0, 0.5]}}}]
)";

/// A method, and the parameter of which it takes many: substeps or iterations.
using LongStep = std::pair<std::string, std::string>;

std::vector<LongStep> longSteps() {
  std::vector<LongStep> all;
  for (const std::string& method : solverNames()) {
    for (const SolverParameter& parameter : findSolver(method).parameters) {
      if (parameter.name != "substeps" && parameter.name != "iterations") continue;
      all.emplace_back(method, parameter.name);
    }
  }
  return all;
}

/// Overrides with which a step takes seconds: as much of the parameter as a scene may ask for.
std::vector<std::string> overridesOf(const LongStep& step) {
  std::vector<std::string> overrides = {"solver.method=" + step.first, "cloth.particles=[65, 65]"};
  for (const SolverParameter& parameter : findSolver(step.first).parameters) {
    if (parameter.name == "tolerance") overrides.emplace_back("solver.tolerance=0");
    if (parameter.name != step.second) continue;
    const auto most = static_cast<int>(parameter.maximum);
    overrides.push_back("solver." + parameter.name + "=" + std::to_string(most));
  }
  return overrides;
}

/// The part of a simulation that a user sees.
struct Sight {
  explicit Sight(const Simulation& simulation)
      : hash(stateHash(simulation.model(), simulation.state())),
        steps(simulation.stepCount()),
        time(simulation.time()),
        clamp(simulation.clamps().front().pose().position),
        gap(simulation.clamps().front().gap()) {}

  bool operator==(const Sight& other) const {
    return hash == other.hash && steps == other.steps && time == other.time &&
           clamp == other.clamp && gap == other.gap;
  }

  std::uint64_t hash;
  std::uint64_t steps;
  double time;
  Vec3 clamp;
  double gap;
};

class Stopped : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Registry, Stopped, testing::ValuesIn(solverNames()),
                         [](const auto& test) { return test.param; });

TEST_P(Stopped, AStepBeforeItsFirstSubstepChangesNothing) {
  // All methods are stable at this step.
  Simulation simulation(
      parseScene(kScene, "s.yaml", {"solver.method=" + GetParam(), "solver.dt=0.0002"}));
  for (int k = 0; k < 5; ++k) simulation.step();
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  StopFlag stop{true};
  simulation.stopWhen(stop);
  const Sight before(simulation);
  simulation.step();
  EXPECT_TRUE(Sight(simulation) == before);
  EXPECT_FALSE(simulation.failed());
  stop = false;
  simulation.step();
  EXPECT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_EQ(simulation.stepCount(), 6U);
  EXPECT_GT(simulation.clamps().front().pose().position.z(), before.clamp.z());
}

class StoppedWithin : public testing::TestWithParam<LongStep> {};

INSTANTIATE_TEST_SUITE_P(Registry, StoppedWithin, testing::ValuesIn(longSteps()),
                         [](const auto& test) {
                           return test.param.first + "_" + test.param.second;
                         });

/// The flag is set when the step is likely to be within its substeps; the result is the same if it
/// is not yet.
TEST_P(StoppedWithin, AStepChangesNothingAndCanBeSaved) {
  const Scene scene = parseScene(kScene, "s.yaml", overridesOf(GetParam()));
  Simulation simulation(scene);
  StopFlag stop{false};
  simulation.stopWhen(stop);
  const Sight before(simulation);
  std::thread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    stop = true;
  });
  simulation.step();
  stopper.join();
  EXPECT_TRUE(Sight(simulation) == before);
  EXPECT_FALSE(simulation.failed());

  Simulation loaded(scene);
  loaded.load(simulation.save());
  EXPECT_TRUE(Sight(loaded) == before);
  loaded.stopWhen(stop);
  loaded.step();  // goes as far as the first substep
  EXPECT_FALSE(loaded.failed());
}

}  // namespace
}  // namespace cloth_sim
