/// \file Closest points of four pairs at a time, against those of one.

#include "contact/closest_lanes.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "contact/closest_points.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

/// The corners of four pairs, by corner and pair.
using FourPairs = std::array<std::array<Vec3, kLanes>, 4>;

std::array<Lanes3, 4> lanesOf(const FourPairs& pairs) {
  std::array<Lanes3, 4> lanes{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (int lane = 0; lane < kLanes; ++lane) {
      lanes[i].x[lane] = pairs[i][lane].x();
      lanes[i].y[lane] = pairs[i][lane].y();
      lanes[i].z[lane] = pairs[i][lane].z();
    }
  }
  return lanes;
}

/// Corners on a grid of a few points, so that many are parallel, aligned, above a side or the same;
/// or anywhere.
FourPairs randomPairs(std::mt19937& random, bool onGrid) {
  std::uniform_int_distribution<int> step(-2, 2);
  std::uniform_real_distribution<double> anywhere(-1.0, 1.0);
  FourPairs pairs;
  for (auto& corner : pairs) {
    for (Vec3& p : corner) {
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] = onGrid ? 0.5 * step(random) : anywhere(random);
      }
    }
  }
  return pairs;
}

Vec3 across(const ClosestLanes& found, const FourPairs& pairs, int lane) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < 4; ++i) sum += found.weight[i][lane] * pairs[i][lane];
  return sum;
}

class ClosestInLanes : public testing::TestWithParam<bool> {};

TEST_P(ClosestInLanes, OfSegmentsAreThoseOfOnePair) {
  std::mt19937 random(1);
  for (int k = 0; k < 5000; ++k) {
    const FourPairs pairs = randomPairs(random, GetParam());
    const ClosestLanes found = closestOnSegments(lanesOf(pairs));
    for (int lane = 0; lane < kLanes; ++lane) {
      const Vec3 &a = pairs[0][lane], &b = pairs[1][lane], &c = pairs[2][lane], &d = pairs[3][lane];
      const SegmentPoints at = closestOnSegments(a, b, c, d);
      const double apart = (a + at.s * (b - a) - c - at.t * (d - c)).norm();
      EXPECT_NEAR(std::sqrt(found.square[lane]), apart, 1e-7) << k;
      EXPECT_NEAR(across(found, pairs, lane).norm(), apart, 1e-7) << k;
      if (apart < 1e-3 || a == b || c == d) continue;
      EXPECT_EQ(found.weight[1][lane] == 0.0, at.s == 0.0) << k;
      EXPECT_EQ(found.weight[2][lane] == 0.0, at.t == 1.0) << k;
    }
  }
}

TEST_P(ClosestInLanes, OfTrianglesAreThoseOfOnePair) {
  std::mt19937 random(2);
  for (int k = 0; k < 5000; ++k) {
    const FourPairs pairs = randomPairs(random, GetParam());
    const ClosestLanes found = closestOnTriangles(lanesOf(pairs));
    for (int lane = 0; lane < kLanes; ++lane) {
      const Corners triangle{pairs[1][lane], pairs[2][lane], pairs[3][lane]};
      const std::array<double, 3> weight = closestOnTriangle(pairs[0][lane], triangle);
      Vec3 apart = pairs[0][lane];
      for (int i = 0; i < 3; ++i) apart -= weight[i] * triangle[i];
      EXPECT_NEAR(std::sqrt(found.square[lane]), apart.norm(), 1e-9) << k;
      EXPECT_NEAR(across(found, pairs, lane).norm(), apart.norm(), 1e-9) << k;
      const Vec3 ab = triangle[1] - triangle[0];
      if (ab.cross(triangle[2] - triangle[0]).norm() < 1e-9) continue;  // several may be closest
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(-found.weight[i + 1][lane], weight[i], 1e-7) << k;
        if (GetParam()) continue;
        EXPECT_EQ(found.weight[i + 1][lane] == 0.0, weight[i] == 0.0) << k;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OnAGrid, ClosestInLanes, testing::Bool());

}  // namespace
}  // namespace cloth_sim
