/// \file Which corners and edges of a surface count as sharp, and the search for them.

#include "contact/sharp_features.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "unit/surfaces.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kFar = 1e3;

std::vector<std::int32_t> allOf(const SharpFeatures& features) {
  std::vector<std::int32_t> found;
  features.find(Vec3::Constant(-kFar), Vec3::Constant(kFar), found);
  return found;
}

std::pair<int, int> edgesAndCorners(const SharpFeatures& features) {
  const std::vector<std::int32_t> all = allOf(features);
  const auto corners =
      std::count_if(all.begin(), all.end(), [&](std::int32_t k) { return features[k].isCorner; });
  return {static_cast<int>(all.size() - corners), static_cast<int>(corners)};
}

/// A cone around z with its tip at the top. \param sides  triangles of its mantle.
SurfaceParts coneOf(double radius, double height, int sides) {
  SurfaceParts cone;
  cone.vertices = {Vec3(0.0, 0.0, height), Vec3::Zero()};
  for (int k = 0; k < sides; ++k) {
    const double angle = 2.0 * 3.141592653589793 * k / sides;
    cone.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  }
  for (int k = 0; k < sides; ++k) {
    const int a = 2 + k;
    const int b = 2 + (k + 1) % sides;
    cone.triangles.insert(cone.triangles.end(), {{{0, a, b}}, {{1, b, a}}});
  }
  return cone;
}

TEST(SharpFeatures, ACubeHasTwelveEdgesAndEightCorners) {
  const SharpFeatures features(*defaultSurface().surface);
  EXPECT_EQ(edgesAndCorners(features), std::make_pair(12, 8)) << "no diagonals";
  for (const std::int32_t k : allOf(features)) {
    const SharpFeature& it = features[k];
    EXPECT_GT(it.outwards.normalized().dot((it.ends[0] + it.ends[1]).normalized()), 0.99);
  }
}

TEST(SharpFeatures, ASmoothBallHasNone) {
  EXPECT_TRUE(SharpFeatures(ballOf(0.3, 4).surface()).empty());
  EXPECT_FALSE(SharpFeatures(ballOf(0.3, 0).surface()).empty());
}

TEST(SharpFeatures, ASheetHasItsBorder) {
  EXPECT_EQ(edgesAndCorners(SharpFeatures(sheetOf(1.0, 1.0, 5, 4).surface())),
            std::make_pair(18, 18));
}

TEST(SharpFeatures, ASheetHasItsCreasesHoweverItsTrianglesTurn) {
  SurfaceParts roof;  // two squares on a ridge along y, which falls by 45 degrees
  roof.vertices = {{-1, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {0, 1, 1}, {1, 1, 0}};
  roof.triangles = {{{0, 1, 3}}, {{1, 4, 3}}, {{1, 2, 4}}, {{2, 4, 5}}};
  EXPECT_EQ(edgesAndCorners(SharpFeatures(roof.surface())), std::make_pair(7, 6));
}

TEST(SharpFeatures, TheTipOfAConeIsSharpAndItsMantleIsNot) {
  const SharpFeatures features(coneOf(0.02, 0.1, 64).surface());
  EXPECT_EQ(edgesAndCorners(features), std::make_pair(64, 65)) << "the rim and the tip";
}

TEST(SharpFeatures, AHollowHasNoSharpEdgeInside) {
  SurfaceParts step;  // an L from above, 1 m high: six corners, one of them hollow
  const std::array<Vec2, 6> outline{
      {{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {1.0, 1.0}, {1.0, 2.0}, {0.0, 2.0}}};
  for (const double z : {0.0, 1.0}) {
    for (const Vec2& p : outline) step.vertices.emplace_back(p.x(), p.y(), z);
  }
  for (int k = 0; k < 6; ++k) {
    const int a = k;
    const int b = (k + 1) % 6;
    step.triangles.insert(step.triangles.end(), {{{a, b, b + 6}}, {{a, b + 6, a + 6}}});
  }
  for (const auto& [a, b, c] : {std::array<int, 3>{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    step.triangles.insert(step.triangles.end(), {{{a, c, b}}, {{a + 6, b + 6, c + 6}}});
  }
  ASSERT_TRUE(step.surface().isClosed());
  const SharpFeatures features(step.surface());
  EXPECT_EQ(edgesAndCorners(features).first, 17) << "18 edges, of which one is hollow";
}

TEST(SharpFeatures, TheSearchFindsWhatMeetsTheBox) {
  const SharpFeatures features(sheetOf(1.0, 1.0, 40, 40).surface());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-0.6, 0.6);
  for (int round = 0; round < 200; ++round) {
    const Vec3 low(coordinate(random), coordinate(random), -0.1);
    const Vec3 high = low + Vec3(0.2, 0.1, 0.2);
    std::vector<std::int32_t> expected;
    for (const std::int32_t k : allOf(features)) {
      const auto& [a, b] = features[k].ends;
      const Vec3 least = a.cwiseMin(b);
      const Vec3 most = a.cwiseMax(b);
      if ((least - high).maxCoeff() <= 0.0 && (low - most).maxCoeff() <= 0.0) expected.push_back(k);
    }
    std::vector<std::int32_t> found;
    features.find(low, high, found);
    EXPECT_EQ(found, expected);
    EXPECT_EQ(features.areIn(low, high), !expected.empty());
  }
}

}  // namespace
}  // namespace cloth_sim
