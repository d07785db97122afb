/// \file Sides of, distances to and crossings of paths in material coordinates.

#include "cloth_sim/surgery/material_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace cloth_sim {
namespace {

const MaterialPath kUp{{0.0, 0.0}, {0.0, 1.0}};
/// A path with a corner: along +v, then along -u.
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

/// Tests both directions of the path and of the segment.
void expectSeparates(const MaterialPath& path, const Vec2& p, const Vec2& q, bool expected) {
  MaterialPath back = path;
  std::reverse(back.begin(), back.end());
  for (const MaterialPath& way : {path, back}) {
    EXPECT_EQ(separates(way, p, q), expected) << p.transpose() << " to " << q.transpose();
    EXPECT_EQ(separates(way, q, p), expected) << q.transpose() << " to " << p.transpose();
  }
}

TEST(Separates, WhatLiesOnDifferentSidesAndCrosses) {
  expectSeparates(kUp, {-0.1, 0.5}, {0.1, 0.5}, true);
  expectSeparates(kUp, {-0.1, 0.2}, {0.3, 0.9}, true);
  expectSeparates(kUp, {0.1, 0.2}, {0.3, 0.9}, false);
  expectSeparates(kUp, {-0.1, 1.5}, {0.1, 1.5}, false);  // beyond its end
  expectSeparates(kUp, {-0.1, 1.0 + 1e-6}, {0.1, 1.0 + 1e-6}, false);
}

TEST(Separates, AtTheEndOfThePathToo) {
  expectSeparates(kUp, {-0.1, 1.0}, {0.1, 1.0}, true);
  expectSeparates(kUp, {-0.1, 0.0}, {0.1, 0.0}, true);
}

TEST(Separates, NotWhatEndsOnThePath) {
  expectSeparates(kUp, {0.0, 0.5}, {0.1, 0.5}, false);
  expectSeparates(kUp, {0.9e-9, 0.5}, {-0.1, 0.5}, false);
  expectSeparates(kUp, {1.1e-9, 0.5}, {-0.1, 0.5}, true);
  expectSeparates(kUp, {0.0, 0.2}, {0.0, 0.4}, false);   // along it
  expectSeparates(kUp, {0.0, -0.2}, {0.0, 1.4}, false);  // over all of it
  // Mesh edges that end at a vertex of a cut, on either side.
  expectSeparates(kCorner, {0.0, 1.0}, {0.3, 1.2}, false);
  expectSeparates(kCorner, {0.0, 1.0}, {-0.3, 0.8}, false);
}

TEST(Separates, BySomeSegmentOfThePath) {
  expectSeparates(kCorner, {-0.5, 0.9}, {-0.5, 1.1}, true);
  expectSeparates(kCorner, {-0.5, 0.5}, {0.5, 0.5}, true);
  expectSeparates(kCorner, {-0.5, 0.1}, {-0.5, 0.9}, false);
  // Through the corner, from inside to outside.
  expectSeparates(kCorner, {-0.1, 0.9}, {0.1, 1.1}, true);
}

TEST(Separates, ImpliesCrossing) {
  std::mt19937_64 random(4);
  const auto uniform = [&] { return 3.0 * static_cast<double>(random() >> 11) * 0x1.0p-53 - 1.5; };
  int separated = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec2 p(uniform(), uniform());
    const Vec2 q(uniform(), uniform());
    // Points at random do not lie on the path: there both mean the same.
    EXPECT_EQ(separates(kCorner, p, q), crosses(kCorner, p, q));
    separated += separates(kCorner, p, q) ? 1 : 0;
  }
  EXPECT_GT(separated, 200);
}

}  // namespace
}  // namespace cloth_sim
