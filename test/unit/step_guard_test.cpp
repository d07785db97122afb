#include "cloth_sim/solver/step_guard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kStep = 1.0 / 60.0;

std::string sceneWith(const std::string& method, const std::string& guard) {
  return "cloth: {size: [0.2, 0.2], particles: [9, 9], fabric: interlock, pins: [last_row]}\n"
         "solver: {method: " +
         method + ", substeps: 1, step_guard: " + guard + "}\n";
}

std::string refusalOf(const std::string& yaml) {
  try {
    Simulation(parseScene(yaml, "s.yaml"));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

class Guarded : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Registry, Guarded, testing::ValuesIn(boundedSolverNames()),
                         [](const auto& test) { return test.param; });

TEST_P(Guarded, SubdividedStepsAreStable) {
  const SolverInfo& info = findSolver(GetParam());
  Simulation simulation(parseScene(sceneWith(GetParam(), "subdivide"), "s.yaml"));
  for (int k = 0; k < 30; ++k) simulation.step();
  EXPECT_FALSE(simulation.failed()) << simulation.failure();
  const Simulation fresh(parseScene(sceneWith(GetParam(), "allow"), "s.yaml"));
  const FastestMode mode = estimateFastestMode(fresh.model(), fresh.state());
  const int needed = stableSubsteps(info, mode, kStep);
  EXPECT_EQ(simulation.lastReport().substeps, std::max(1, needed));
  EXPECT_EQ(needed > 1, std::isfinite(info.stabilityLimit));
}

TEST_P(Guarded, TooFewSubstepsAreRefusedWithTheNumberThatItTakes) {
  const std::string refusal = refusalOf(sceneWith(GetParam(), "refuse"));
  if (std::isinf(findSolver(GetParam()).stabilityLimit)) {
    EXPECT_EQ(refusal, "");
    return;
  }
  EXPECT_THAT(refusal, testing::StartsWith("solver.substeps: " + GetParam() + " is stable with "));
  EXPECT_THAT(refusal, testing::EndsWith(" or more (got 1)"));
}

TEST(StepGuard, LongStepsAreTakenIfTheyAreAllowed) {
  Simulation simulation(parseScene(sceneWith("verlet", "allow"), "s.yaml"));
  for (int k = 0; k < 60 && !simulation.failed(); ++k) simulation.step();
  EXPECT_TRUE(simulation.failed());
}

TEST(StepGuard, NoNumberOfSubstepsHelpsAMethodThatIsNeverStable) {
  for (const char* guard : {"subdivide", "refuse"}) {
    EXPECT_THAT(refusalOf(sceneWith("explicit_euler", guard)),
                testing::HasSubstr("explicit_euler is stable at no step"));
  }
  EXPECT_EQ(refusalOf(sceneWith("explicit_euler", "allow")), "");
}

TEST(StepGuard, MoreSubstepsThanItTakesStay) {
  const Model model = buildModel(clothOf(5, 5, 0.1));
  const SolverInfo& info = findSolver("verlet");
  SolverParameters parameters = completeParameters(info, {});
  parameters["substeps"] = 5000;
  const FastestMode mode = boundFastestMode(model);
  EXPECT_EQ(guardStep(StepGuard::kSubdivide, info, mode, kStep, parameters), parameters);
  EXPECT_EQ(guardStep(StepGuard::kRefuse, info, mode, kStep, parameters), parameters);
}

TEST(StepGuard, AHigherLimitTakesFewerSubsteps) {
  const Model model = buildModel(clothOf(5, 5, 0.1));
  const FastestMode mode = boundFastestMode(model);
  const int verlet = stableSubsteps(findSolver("verlet"), mode, 1.0);
  const int rungeKutta = stableSubsteps(findSolver("rk4"), mode, 1.0);
  EXPECT_EQ(verlet, static_cast<int>(std::ceil(1.0 / stableStep(model))));
  EXPECT_NEAR(static_cast<double>(verlet) / rungeKutta, std::sqrt(2.0), 0.02);
}

TEST(StepGuard, ForwardEulerIsDividedWhereEverythingIsDamped) {
  // Interlock of 25 mm cells with tau = 1 ms: the fastest mode oscillates, so h < tau.
  const std::string damped =
      "cloth: {size: [0.2, 0.2], particles: [9, 9], fabric: {preset: interlock, damping: 1.0e-4}, "
      "pins: [last_row]}\nsolver: {method: explicit_euler, substeps: 1, step_guard: subdivide}\n";
  Simulation simulation(parseScene(damped, "s.yaml"));
  for (int k = 0; k < 30; ++k) simulation.step();
  EXPECT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_GE(simulation.lastReport().substeps, std::floor(kStep / 1e-4));
  EXPECT_EQ(simulation.guard().redone, 0);
  EXPECT_LT(meanSpeed(simulation.state()), 5.0);
}

TEST(StepGuard, AStepThatGainsEnergyIsRedoneFiner) {
  // Thrown at 20 m/s, the cloth is whipped over its pins and crumples: springs line up, and the
  // steps that were long enough for the flat cloth are too long.
  Scene scene = parseScene(sceneWith("verlet", "subdivide"), "s.yaml");
  scene.cloths[0].velocity = Vec3(0.0, 0.0, 20.0);
  Simulation watched(scene);
  const double before = energies(watched.model(), watched.state(), Vec3::Zero()).kinetic;
  double most = 0.0;
  for (int k = 0; k < 60; ++k) {
    watched.step();
    ASSERT_FALSE(watched.failed()) << watched.failure();
    const Energies e = energies(watched.model(), watched.state(), Vec3::Zero());
    most = std::max(most, e.kinetic + e.elastic);
  }
  EXPECT_GT(watched.guard().redone, 0);
  EXPECT_GT(watched.guard().finest, 1);
  // Thrown at 18 to 22 m/s it gains 3.4 to 13.7 times: where it is whipped to depends on rounding.
  EXPECT_LT(most, 20.0 * before);

  // Without the guard, with the substeps that it chose at the start.
  scene.solver.guard = StepGuard::kAllow;
  scene.solver.parameters["substeps"] = watched.guard().chosenSubsteps;
  Simulation alone(scene);
  double mostAlone = 0.0;
  for (int k = 0; k < 60 && !alone.failed(); ++k) {
    alone.step();
    const Energies e = energies(alone.model(), alone.state(), Vec3::Zero());
    mostAlone = std::max(mostAlone, e.kinetic + e.elastic);
  }
  EXPECT_TRUE(alone.failed() || mostAlone > 20.0 * before) << mostAlone / before;
}

TEST(StepGuard, IsNotRousedByAYankOrAFall) {
  // Energy that clamps, gravity and obstacles put in is theirs to put in.
  const std::string scene = R"(
cloth: {size: [0.2, 0.2], particles: [9, 9], fabric: interlock, pose: {position: [0, 0, 0.1]}}
solver: {method: verlet, substeps: 1, step_guard: subdivide}
obstacles: {floor: {type: plane}}
clamps: {left: {patch: {particle: [0, 4], radius: 2}, max_speed: 10}}
phases:
  - {name: fall, timeout: 0.2, on_timeout: continue}
  - {name: yank, clamps: {left: {grasp: true, move_by: [-2, 0, 1], speed: 10}}, timeout: 0.4}
)";
  Simulation simulation(parseScene(scene, "s.yaml"));
  for (int k = 0; k < 30; ++k) simulation.step();
  EXPECT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_EQ(simulation.guard().redone, 0);
}

TEST(StepGuard, IsReadStrictly) {
  EXPECT_THAT(refusalOf(sceneWith("verlet", "maybe")), testing::HasSubstr("solver.step_guard"));
}

}  // namespace
}  // namespace cloth_sim
