/// \file Paths of strokes through flat cloth.

#include "cloth_sim/surgery/stroke.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "unit/stroke_support.h"

namespace cloth_sim {
namespace {

using namespace stroke_support;

double areaWithin(const SurfacePath& path) {
  double area = 0.0;
  for (std::size_t k = 0; k + 1 < path.points.size(); ++k) {
    const Vec2& a = path.points[k].material;
    const Vec2& b = path.points[k + 1].material;
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return area;
}

TEST(StrokeAlong, ReachesToBothSidesWithTheHeelAgainstTheDirection) {
  const Stroke stroke = strokeAlong({{1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}}, {0.0, 0.0, -3.0}, 0.5);
  ASSERT_EQ(stroke.poses.size(), 2U);
  EXPECT_EQ(stroke.poses[0].heel, Vec3(1.0, 0.0, 0.5));
  EXPECT_EQ(stroke.poses[0].tip, Vec3(1.0, 0.0, -0.5));
  EXPECT_EQ(stroke.poses[1].heel, Vec3(2.0, 0.0, 0.5));
}

TEST(StrokeValidation, NamesWhatIsWrong) {
  const Stroke good = drawn({{0.0, 0.0}, {1.0, 0.0}});
  EXPECT_EQ(validationError(good), "");
  Stroke stroke = good;
  stroke.poses.pop_back();
  EXPECT_EQ(validationError(stroke), "the stroke needs at least two poses of the blade");
  stroke = drawn({{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}});
  EXPECT_EQ(validationError(stroke), "the stroke needs at least two different poses of the blade");
  stroke = good;
  stroke.poses[1].tip.y() = std::nan("");
  EXPECT_EQ(validationError(stroke), "the stroke's poses: expected finite numbers");
  for (const double far : {1e308, -1e9, 1.1e6}) {  // volumes overflow: a node crashed
    stroke = good;
    stroke.poses[1].heel.x() = far;
    EXPECT_EQ(validationError(stroke), "the stroke's poses: expected coordinates of at most 1e6 m");
  }
  EXPECT_EQ(validationError(drawn({{0.0, 0.0}, {1.0, 0.0}}, 0.0)), "the blade needs a length");
  for (double halfWidth : {-1.0, std::numeric_limits<double>::infinity()}) {
    stroke = good;
    stroke.halfWidth = halfWidth;
    EXPECT_NE(validationError(stroke), "");
  }
}

TEST(FindPaths, RefusesAnInvalidStroke) {
  const Cloth cloth = squareCloth();
  EXPECT_THROW(pathsOf(Stroke{}, cloth), std::invalid_argument);
}

TEST(FindPaths, MissesWhatItDoesNotReach) {
  const Cloth cloth = squareCloth();
  EXPECT_TRUE(pathsOf(drawn({{-1.0, 1.1}, {2.0, 1.1}}), cloth).empty());
  EXPECT_TRUE(pathsOf(drawn({{-1.0, 0.3}, {-0.1, 0.3}}), cloth).empty());
  Stroke above = drawn({{-1.0, 0.3}, {2.0, 0.3}});
  for (Blade& blade : above.poses) blade.heel.z() += 0.5, blade.tip.z() += 0.5;
  EXPECT_TRUE(pathsOf(above, cloth).empty());
}

TEST(FindPaths, CrossesTheClothFromBorderToBorder) {
  const Cloth cloth = squareCloth();
  for (const double out : {0.5, 1e4}) {  // however far it comes from
    const double y = 0.3;
    const SurfacePath path = onlyPath(drawn({{-out, y}, {1.0 + out, y}}), cloth);
    // 9 lines across, and the diagonals of 8 cells in between.
    EXPECT_EQ(path.points.size(), 17U);
    expectAt(path.points.front(), {0.0, y});
    expectAt(path.points.back(), {1.0, y});
    EXPECT_FALSE(path.isClosed());
  }
  expectAt(onlyPath(drawn({{1.5, 0.3}, {-0.5, 0.3}}), cloth).points.front(), {1.0, 0.3});
}

TEST(FindPaths, BeginsAndEndsInsideOfFaces) {
  const Cloth cloth = squareCloth();
  const Vec2 a(0.26, 0.255), b(0.36, 0.26);  // both in the lower face of cell (2, 2)
  const SurfacePath inside = onlyPath(drawn({a, b}), cloth);
  ASSERT_EQ(inside.points.size(), 2U);
  expectAt(inside.points[0], a);
  expectAt(inside.points[1], b);
  EXPECT_EQ(inside.points[0].face, 2 * (2 * 8 + 2));
  EXPECT_EQ(inside.points[1].face, 2 * (2 * 8 + 2));

  const SurfacePath out = onlyPath(drawn({a, {1.3, a.y()}}), cloth);
  expectAt(out.points.front(), a);
  expectAt(out.points.back(), {1.0, a.y()});
}

/// Strokes through vertices, along mesh edges, along the border, and along the diagonals.
TEST(FindPaths, GoesThroughVerticesAndAlongEdges) {
  for (int count : {9, 12}) {  // exact coordinates, and rounded ones
    const Cloth cloth = squareCloth(count);
    const double row = cloth.grid.spacingV() * 3.0;
    const SurfacePath along = onlyPath(drawn({{-0.5, row}, {1.5, row}}), cloth);
    EXPECT_EQ(along.points.size(), static_cast<std::size_t>(count));
    EXPECT_NEAR(lengthOf(along), 1.0, kRounding);
    EXPECT_NEAR(lengthOf(onlyPath(drawn({{row, 1.5}, {row, -0.5}}), cloth)), 1.0, kRounding);
    const SurfacePath diagonal = onlyPath(drawn({{-0.5, -0.5}, {1.5, 1.5}}), cloth);
    EXPECT_NEAR(lengthOf(diagonal), std::sqrt(2.0), kRounding);
    EXPECT_EQ(diagonal.points.size(), static_cast<std::size_t>(count));
    const SurfacePath across = onlyPath(drawn({{-0.5, 1.5}, {1.5, -0.5}}), cloth);
    EXPECT_NEAR(lengthOf(across), std::sqrt(2.0), kRounding);
    EXPECT_NEAR(lengthOf(onlyPath(drawn({{row, row}, {row, 2 * row}}), cloth)), row, kRounding);
    EXPECT_LE(pathsOf(drawn({{-0.5, 0.0}, {1.5, 0.0}}), cloth).size(), 1U);
  }
}

/// Strokes with corners at vertices and on edges, and the next pose anywhere.
TEST(FindPaths, TurnsAtVertices) {
  for (int count : {9, 12}) {
    const Cloth cloth = squareCloth(count);
    const Vec2 corner = cloth.mesh.material(cloth.grid.vertex(4, 4));
    for (int k = 0; k < 32; ++k) {
      const Vec2 way(std::cos(k * kPi / 16.0), std::sin(k * kPi / 16.0));
      const Vec2 from = corner - Vec2(0.3, 0.0);
      const Vec2 to = corner + 0.3 * way;
      const SurfacePath path = onlyPath(drawn({from, corner, to}), cloth);
      EXPECT_TRUE(hasPointAt(path, corner)) << k;
      EXPECT_NEAR(lengthOf(path), 0.6, kRounding) << k;
      expectAt(path.points.front(), from);
      expectAt(path.points.back(), to);
    }
  }
}

TEST(FindPaths, CrossesNothingThatLiesInThePlaneOfTheSweptSurface) {
  Cloth cloth = squareCloth();
  Stroke stroke = strokeAlong({{-1.0, 0.5, 0.0}, {2.0, 0.5, 0.0}}, Vec3::UnitY(), 0.3);
  EXPECT_TRUE(pathsOf(stroke, cloth).empty());
  // The same in a plane whose coordinates are all rounded.
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(0.3, 0.5, -0.4).normalized()));
  for (Vec3& p : cloth.x) p = turn * Vec3(p);
  for (Blade& blade : stroke.poses) blade = {turn * blade.heel, turn * blade.tip};
  EXPECT_TRUE(pathsOf(stroke, cloth).empty());
}

TEST(FindPaths, GivesOnePathPerConnectedLine) {
  const Cloth cloth = squareCloth();
  // Over a corner: in at the left, out at the top; in again, out at the bottom.
  const auto two = pathsOf(drawn({{-0.5, 0.2}, {0.2, 1.2}, {0.7, 1.2}, {0.7, -0.5}}), cloth);
  expectSound(two, cloth.mesh);
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].points.front().material.x(), 0.0);
  EXPECT_EQ(two[0].points.back().material.y(), 1.0);
  expectAt(two[1].points.front(), {0.7, 1.0});
  expectAt(two[1].points.back(), {0.7, 0.0});
}

TEST(FindPaths, HasAPointWhereTheStrokeTurnsAndNoneWhereItDoesNot) {
  const Cloth cloth = squareCloth();
  const Vec2 turn(0.43, 0.56);
  const Vec2 straight(0.2, 0.56);
  const SurfacePath path = onlyPath(drawn({{-0.5, 0.56}, straight, turn, {0.43, 1.5}}), cloth);
  EXPECT_TRUE(hasPointAt(path, turn));
  EXPECT_FALSE(hasPointAt(path, straight));
}

TEST(FindPaths, ClosesACircle) {
  const Cloth cloth = squareCloth(33);
  const std::vector<Vec2> corners = circle(64);
  const SurfacePath path = onlyPath(drawn(corners), cloth);
  EXPECT_TRUE(path.isClosed());
  expectAt(path.points.front(), corners.front());
  for (const Vec2& corner : corners) EXPECT_TRUE(hasPointAt(path, corner));
  const double area = 0.5 * 64 * 0.3 * 0.3 * std::sin(2.0 * kPi / 64);
  EXPECT_NEAR(areaWithin(path), area, kRounding);
  // One that ends short of its first point is open.
  std::vector<Vec2> open = corners;
  open.back() = 0.5 * (open.back() + open[63]);
  EXPECT_FALSE(onlyPath(drawn(open), cloth).isClosed());
}

TEST(FindPaths, FollowsAnSCurve) {
  const Cloth cloth = squareCloth(33);
  std::vector<Vec2> points;
  for (int k = 0; k <= 100; ++k) {
    const double x = -0.1 + 1.2 * k / 100;
    points.emplace_back(x, 0.5 + 0.3 * std::sin(2.0 * kPi * x));
  }
  const SurfacePath path = onlyPath(drawn(points), cloth);
  for (std::size_t k = 9; k <= 91; ++k) EXPECT_TRUE(hasPointAt(path, points[k])) << k;  // inside
  for (std::size_t k = 0; k + 1 < path.points.size(); ++k) {
    EXPECT_LT(path.points[k].material.x(), path.points[k + 1].material.x());
  }
}

TEST(FindPaths, LetsAStrokeCrossItself) {
  const Cloth cloth = squareCloth();
  const SurfacePath path =
      onlyPath(drawn({{-0.5, 0.4}, {0.8, 0.4}, {0.8, 0.7}, {0.4, 0.7}, {0.4, -0.5}}), cloth);
  EXPECT_NEAR(lengthOf(path), 0.8 + 0.3 + 0.4 + 0.7, kRounding);
}

TEST(FindPaths, GoesBackOverItself) {
  const Cloth cloth = squareCloth();
  for (const double y : {0.3, 0.25}) {
    const SurfacePath path = onlyPath(drawn({{0.1, y}, {0.8, y}, {0.2, y}}), cloth);
    EXPECT_NEAR(lengthOf(path), 0.7 + 0.6, kRounding);
  }
}

}  // namespace
}  // namespace cloth_sim
