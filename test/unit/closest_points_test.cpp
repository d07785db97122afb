/// \file Closest points of triangles and segments, and directions that separate triangles.

#include "contact/closest_points.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "layer_support.h"
#include "verify/intersections.h"

namespace cloth_sim {
namespace {

TEST(ClosestPoints, OfATriangleBeatAllOthers) {
  RandomPoints random(1);
  for (int k = 0; k < 500; ++k) {
    const Corners t{random.point(), random.point(), random.point()};
    const Vec3 p = random.point();
    const auto distance = [&](double u, double v) {
      return (p - (1.0 - u - v) * t[0] - u * t[1] - v * t[2]).norm();
    };
    const std::array<double, 3> w = closestOnTriangle(p, t);
    const double found = distance(w[1], w[2]);
    for (double u = 0.0; u <= 1.0; u += 0.125) {
      for (double v = 0.0; u + v <= 1.0; v += 0.125) EXPECT_LE(found, distance(u, v) + 1e-12);
    }
  }
}

TEST(ClosestPoints, OfSegmentsBeatAllOthers) {
  RandomPoints random(2);
  for (int k = 0; k < 500; ++k) {
    const Vec3 a0 = random.point(), a1 = random.point(), b0 = random.point();
    const Vec3 b1 = k % 5 == 0 ? Vec3(b0 + 2.0 * (a1 - a0)) : random.point();  // parallel, too
    const auto distance = [&](double s, double t) {
      return (a0 + s * (a1 - a0) - b0 - t * (b1 - b0)).norm();
    };
    const SegmentPoints at = closestOnSegments(a0, a1, b0, b1);
    for (double s = 0.0; s <= 1.0; s += 0.1) {
      for (double t = 0.0; t <= 1.0; t += 0.1) {
        EXPECT_LE(distance(at.s, at.t), distance(s, t) + 1e-12);
      }
    }
  }
}

TEST(ClosestPoints, TrianglesApartHaveASeparatingDirectionAndOthersHaveNot) {
  RandomPoints random(3);
  int apart = 0;
  for (int k = 0; k < 2000; ++k) {
    std::vector<Vec3> x;
    for (int v = 0; v < 6; ++v) x.push_back(random.point());
    const bool meet = pierces({0, 1, 2}, {3, 4, 5}, x) || pierces({3, 4, 5}, {0, 1, 2}, x);
    const SeparatingDirection found = separate({x[0], x[1], x[2]}, {x[3], x[4], x[5]});
    EXPECT_EQ(found.distance > 0.0, !meet);
    apart += meet ? 0 : 1;
  }
  EXPECT_GT(apart, 200);
  EXPECT_LT(apart, 1800);
}

TEST(ClosestPoints, TrianglesThatShareACornerHaveASeparatingDirectionUnlessTheyMeet) {
  RandomPoints random(4);
  int apart = 0;
  for (int k = 0; k < 2000; ++k) {
    std::vector<Vec3> x{Vec3::Zero()};
    for (int v = 0; v < 4; ++v) x.push_back(random.point());
    // Two triangles with a common corner meet elsewhere if and only if their cones do.
    const std::vector<Vec3> far{Vec3::Zero(), 9.0 * x[1], 9.0 * x[2], 9.0 * x[3], 9.0 * x[4]};
    std::vector<Vec3> mixed = x;
    mixed.insert(mixed.end(), far.begin() + 1, far.end());
    const bool meet = pierces({0, 1, 2}, {0, 7, 8}, mixed) || pierces({0, 3, 4}, {0, 5, 6}, mixed);
    const SeparatingDirection found = separateAtVertex({x[1], x[2]}, {x[3], x[4]});
    EXPECT_EQ(found.distance > 0.0, !meet) << k;
    apart += meet ? 0 : 1;
  }
  EXPECT_GT(apart, 200);
  EXPECT_LT(apart, 1950);
}

}  // namespace
}  // namespace cloth_sim
