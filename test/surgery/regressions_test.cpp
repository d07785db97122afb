/// \file Sequences that failed once, as RapidCheck shrank them.

#include <gtest/gtest.h>

#include "surgery/cloth_fixture.h"

namespace cloth_sim {
namespace {

using namespace surgery_support;

struct Regression {
  const char* name;
  ClothCase cloth;
  std::vector<Operation> operations;
};

void PrintTo(const Regression& regression, std::ostream* out) { *out << regression.name; }

class Regressions : public testing::TestWithParam<Regression> {};

TEST_P(Regressions, IsGoneForGood) {
  EXPECT_EQ(operateAll(GetParam().cloth, GetParam().operations), "");
}

INSTANTIATE_TEST_SUITE_P(
    Found, Regressions,
    testing::Values(
        // A vertex that moves onto a cut can turn a structural spring into a shear spring in the
        // same slot: the counts by kind were not updated.
        Regression{"SpringChangesItsKind",
                   {6, 5, 10, 0, 0, -1, true, true, false, false, 0},
                   {{Kind::kStroke, {{-3, -3}, {5, 11}}, 0, false, false, false, 0, 0, 0}}},
        Regression{"SpringChangesItsKindAfterRefinement",
                   {4, 4, 10, 0, 0, -1, true, true, false, false, 0},
                   {{Kind::kRefine, {{-3, -3}}, 0, false, false, false, 5, 2, 0},
                    {Kind::kStroke, {{0, 5}, {3, -1}}, 0, false, false, false, 0, 0, 0}}},
        // A bisection that fails may have bisected other faces before: the refinement ignored the
        // new faces and vertices and read beyond the end of its tables.
        Regression{"BisectionIsRefusedHalfWay",
                   {4, 4, 10, 0, 1, -1, true, true, false, false, 0},
                   {{Kind::kStroke, {{-3, 5}, {12, -1}}, 0, false, false, false, 0, 0, 0},
                    {Kind::kStroke, {{-3, -3}, {1, 4}}, 0, false, false, false, 3, 3, 0}}},
        // Two shear springs with the same ends across two edges of one vertex.
        Regression{"TwinSpringsInAStrip",
                   {4, 4, 10, 0, 0, -1, true, true, false, false, 0},
                   {{Kind::kStroke, {{-3, -3}, {-3, 0}}, 0, true, false, false, 0, 3, 3}}},
        // Of two neighbours in equally straight directions, the numbers decide, and these had
        // changed.
        Regression{"RemovedComponentRenumbersTies",
                   {4, 5, 5, 0, 0, -1, true, true, false, false, 0},
                   {{Kind::kStroke, {{12, 11}, {-3, -3}, {1, 7}}, 0, false, true, false, 0, 0, 0},
                    {Kind::kRemoveComponent, {{-3, -3}}, 0, false, false, false, 0, 0, 0}}}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace cloth_sim
