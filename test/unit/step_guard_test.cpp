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
  const int needed = stableSubsteps(info, simulation.model(), kStep);
  EXPECT_EQ(simulation.lastReport().substeps, std::max(1, needed));
  EXPECT_EQ(needed > 1, std::isfinite(info.stabilityLimit));
}

TEST_P(Guarded, TooFewSubstepsAreRefusedWithTheNumberThatItTakes) {
  const std::string refusal = refusalOf(sceneWith(GetParam(), "refuse"));
  if (std::isinf(findSolver(GetParam()).stabilityLimit)) {
    EXPECT_EQ(refusal, "");
    return;
  }
  EXPECT_THAT(refusal,
              testing::StartsWith("solver.substeps: " + GetParam() + " is surely stable with "));
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
  EXPECT_EQ(guardStep(StepGuard::kSubdivide, info, model, kStep, parameters), parameters);
  EXPECT_EQ(guardStep(StepGuard::kRefuse, info, model, kStep, parameters), parameters);
}

TEST(StepGuard, AHigherLimitTakesFewerSubsteps) {
  const Model model = buildModel(clothOf(5, 5, 0.1));
  const int verlet = stableSubsteps(findSolver("verlet"), model, 1.0);
  const int rungeKutta = stableSubsteps(findSolver("rk4"), model, 1.0);
  EXPECT_EQ(verlet, static_cast<int>(std::ceil(1.0 / stableStep(model))));
  EXPECT_NEAR(static_cast<double>(verlet) / rungeKutta, std::sqrt(2.0), 0.02);
}

TEST(StepGuard, IsReadStrictly) {
  EXPECT_THAT(refusalOf(sceneWith("verlet", "maybe")), testing::HasSubstr("solver.step_guard"));
}

}  // namespace
}  // namespace cloth_sim
