/// \file The list of methods and their options.

#include "cloth_sim/solver/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "unit/core_support.h"

namespace cloth_sim {
namespace {

std::string messageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "(nothing thrown)";
}

TEST(Registry, IsSortedAndComplete) {
  const std::vector<std::string> names = testing_support::solverNames();
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  EXPECT_THAT(names, testing::IsSupersetOf(
                         {"implicit_euler", "pbd", "rk4", "symplectic_euler", "verlet", "xpbd"}));
  for (const SolverInfo& info : solverRegistry()) {
    EXPECT_FALSE(info.title.empty()) << info.name;
    EXPECT_FALSE(info.reference.empty()) << info.name;
    EXPECT_FALSE(info.limitations.empty()) << info.name;
    EXPECT_EQ(info.order >= 1, info.followsFabric) << info.name;
    EXPECT_EQ(&findSolver(info.name), &info);
  }
}

TEST(Registry, DefaultsAreWithinTheirRanges) {
  for (const SolverInfo& info : solverRegistry()) {
    const SolverParameters complete = completeParameters(info, {});
    EXPECT_EQ(complete.size(), info.parameters.size());
    for (const SolverParameter& parameter : info.parameters) {
      EXPECT_EQ(complete.at(parameter.name), parameter.defaultValue);
      EXPECT_FALSE(parameter.description.empty());
    }
    EXPECT_EQ(completeParameters(info, complete), complete) << "defaults are accepted when given";
    const Model model = buildModel(testing_support::clothOf(3, 3, 0.1));
    EXPECT_NE(info.create(model, complete), nullptr);
  }
}

TEST(Registry, NamesTheKnownMethods) {
  const std::string message = messageOf([] { findSolver("magic"); });
  EXPECT_THAT(message, testing::HasSubstr("method: expected one of "));
  for (const std::string& name : testing_support::solverNames()) {
    EXPECT_THAT(message, testing::HasSubstr(name));
  }
  EXPECT_THAT(message, testing::HasSubstr("(got 'magic')"));
}

class Substeps : public testing::TestWithParam<std::string> {};

TEST_P(Substeps, HaveARange) {
  const SolverInfo& info = findSolver(GetParam());
  const std::string range = "substeps: expected a whole number from 1 to 100000";
  for (const double bad : {0.0, -1.0, 1.5, 100001.0, std::nan("")}) {
    EXPECT_EQ(messageOf([&] { completeParameters(info, {{"substeps", bad}}); }), range) << bad;
  }
  EXPECT_EQ(completeParameters(info, {{"substeps", 7.0}}).at("substeps"), 7.0);
  EXPECT_THAT(messageOf([&] {
                completeParameters(info, {{"substep", 7.0}});
              }),
              testing::StartsWith("substep: " + info.name + " has no such parameter (it has "));
}

INSTANTIATE_TEST_SUITE_P(Registry, Substeps, testing::Values("symplectic_euler", "verlet", "xpbd"),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace cloth_sim
