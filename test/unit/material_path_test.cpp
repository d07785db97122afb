/// \file Sides of, distances to and crossings of paths in material coordinates.

#include "cloth_sim/surgery/material_path.h"

#include <gtest/gtest.h>

namespace cloth_sim {
namespace {

const MaterialPath kUp{{0.0, 0.0}, {0.0, 1.0}};
/// Up, then to the left.
const MaterialPath kCorner{{0.0, 0.0}, {0.0, 1.0}, {-1.0, 1.0}};

TEST(SideOf, IsPositiveToTheRightOfTheDirection) {
  EXPECT_DOUBLE_EQ(sideOf(kUp, {0.3, 0.5}), 0.3);
  EXPECT_DOUBLE_EQ(sideOf(kUp, {-0.3, 0.5}), -0.3);
  EXPECT_DOUBLE_EQ(sideOf({{0.0, 1.0}, {0.0, 0.0}}, {0.3, 0.5}), -0.3);
}

TEST(SideOf, GoesOnBeyondTheEnds) {
  EXPECT_DOUBLE_EQ(sideOf(kUp, {0.3, 7.0}), 0.3);
  EXPECT_DOUBLE_EQ(sideOf(kUp, {-0.3, -7.0}), -0.3);
}

TEST(SideOf, IsZeroWithinANanometre) {
  EXPECT_EQ(sideOf(kUp, {0.0, 0.5}), 0.0);
  EXPECT_EQ(sideOf(kUp, {-0.9e-9, 0.5}), 0.0);
  EXPECT_LT(sideOf(kUp, {-1.1e-9, 0.5}), 0.0);
}

TEST(SideOf, DoesNotFlipAroundACorner) {
  EXPECT_LT(sideOf(kCorner, {-0.1, 0.5}), 0.0);
  EXPECT_LT(sideOf(kCorner, {-0.5, 0.9}), 0.0);
  // Outside of the corner both segments are equally near, and both have these on their right.
  for (const Vec2& p :
       {Vec2(0.1, 1.1), Vec2(0.3, 1.01), Vec2(0.01, 1.3), Vec2(0.2, 0.5), Vec2(-0.5, 1.2)}) {
    EXPECT_GT(sideOf(kCorner, p), 0.0) << p.transpose();
  }
}

TEST(DistanceTo, IsToTheNearestPoint) {
  EXPECT_DOUBLE_EQ(distanceTo(kUp, {0.3, 0.5}), 0.3);
  EXPECT_DOUBLE_EQ(distanceTo(kUp, {0.3, 1.4}), 0.5);
  EXPECT_DOUBLE_EQ(distanceTo(kCorner, {-0.5, 1.25}), 0.25);
  EXPECT_EQ(distanceTo(kCorner, {0.0, 1.0}), 0.0);
}

struct Crossing {
  const char* name;
  Vec2 p, q;
  bool crosses;
};

class CrossesUp : public testing::TestWithParam<Crossing> {};

TEST_P(CrossesUp, IsSymmetricAndRight) {
  const Crossing& c = GetParam();
  EXPECT_EQ(crosses(kUp, c.p, c.q), c.crosses);
  EXPECT_EQ(crosses(kUp, c.q, c.p), c.crosses);
  EXPECT_EQ(crosses({kUp[1], kUp[0]}, c.p, c.q), c.crosses);
}

INSTANTIATE_TEST_SUITE_P(
    All, CrossesUp,
    testing::Values(Crossing{"Across", {-0.1, 0.5}, {0.1, 0.5}, true},
                    Crossing{"Oblique", {-0.1, 0.2}, {0.3, 0.9}, true},
                    Crossing{"Beyond", {-0.1, 1.5}, {0.1, 1.5}, false},
                    Crossing{"Beside", {0.1, 0.2}, {0.2, 0.8}, false},
                    Crossing{"Short", {0.5, 0.5}, {0.1, 0.5}, false},
                    Crossing{"TouchesWithItsEnd", {0.0, 0.5}, {0.4, 0.5}, true},
                    Crossing{"TouchesTheEnd", {-0.1, 1.0}, {0.1, 1.0}, true},
                    Crossing{"JustPastTheEnd", {-0.1, 1.0 + 1e-6}, {0.1, 1.0 + 1e-6}, false},
                    Crossing{"AlongIt", {0.0, 0.2}, {0.0, 0.4}, true},
                    Crossing{"OverlapsAlong", {0.0, 0.9}, {0.0, 1.4}, true},
                    Crossing{"InLineButBeyond", {0.0, 1.2}, {0.0, 1.4}, false}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Crosses, AnySegment) {
  EXPECT_TRUE(crosses(kCorner, {-0.5, 0.9}, {-0.5, 1.1}));
  EXPECT_FALSE(crosses(kCorner, {-0.5, 0.1}, {-0.5, 0.9}));
}

}  // namespace
}  // namespace cloth_sim
