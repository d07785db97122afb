/// \file Strokes of turning blades through folded and crumpled cloth, and through degenerate
/// positions.

#include <gtest/gtest.h>

#include "unit/core_support.h"
#include "unit/stroke_support.h"

namespace cloth_sim {
namespace {

using namespace stroke_support;
using testing_support::Generator;
using testing_support::uniform;

/// Cloth folded at x = `fold`: the part to the right of it lies inverted, `gap` above the rest.
Cloth foldedCloth(double fold, double gap) {
  return shapedCloth({17, 9, 1.0, 1.0}, [=](const Vec3& p) -> Vec3 {
    if (p.x() < fold) return p;
    if (p.x() == fold) return {fold + gap, p.y(), 0.5 * gap};
    return {2.0 * fold - p.x(), p.y(), gap};
  });
}

Vec3 positionOf(const Cloth& cloth, const SurfacePoint& p) {
  const Vec3 weight = weightsIn(cloth.mesh, p.face, p.material);
  Vec3 position = Vec3::Zero();
  for (int k = 0; k < 3; ++k) position += weight[k] * cloth.x[cloth.mesh.face(p.face)[k]];
  return position;
}

/// A blade that twists as it moves: its ends are displaced sideways by up to `twist` each.
Stroke twisted(double twist) {
  Stroke stroke;
  stroke.poses.push_back({{0.1, 0.5, 0.25}, {0.1, 0.5, -0.25}});
  stroke.poses.push_back({{0.9, 0.5 - twist, 0.25}, {0.9, 0.5 + twist, -0.25}});
  return stroke;
}

TEST(FindPaths, FollowsTheRuledSurfaceOfATurningBlade) {
  const double slope = 0.2;
  const Cloth cloth = shapedCloth(
      {9, 9, 1.0, 1.0}, [=](const Vec3& p) { return Vec3(p.x(), p.y(), slope * (p.x() - 0.5)); });
  for (const double twist : {0.0, 0.001, 0.01, 0.3}) {
    const SurfacePath path = onlyPath(twisted(twist), cloth);
    // The slices, 1024 at most, and the points left out.
    const double length = 2.0 * std::hypot(0.25, twist);
    const double allowed = 2.0 * std::max(1e-5 * length, 0.25 * 2.0 * twist / 1024);
    for (const SurfacePoint& p : path.points) {
      const double part = (p.material.x() - 0.1) / 0.8;
      const double blade = (0.25 - slope * (p.material.x() - 0.5)) / 0.5;
      EXPECT_NEAR(p.material.y(), 0.5 + twist * part * (2.0 * blade - 1.0), allowed + kRounding);
    }
    expectAt(path.points.front(), {0.1, 0.5});
    EXPECT_NEAR(path.points.back().material.x(), 0.9, kRounding);
    EXPECT_LT(path.points.size(), 100U);
  }
}

/// A blade that rocks in its plane about its midpoint, which stays in the cloth.
TEST(FindPaths, CutsWithABladeThatTurnsInItsPlane) {
  const Cloth cloth = squareCloth();
  for (const double y : {0.3, 0.375}) {
    Stroke stroke;
    stroke.poses.push_back({{0.2, y, 0.2}, {0.8, y, -0.2}});
    stroke.poses.push_back({{0.2, y, -0.2}, {0.8, y, 0.2}});
    const auto paths = pathsOf(stroke, cloth);
    expectSound(paths, cloth.mesh);
    double length = 0.0;
    for (const SurfacePath& path : paths) length += lengthOf(path);
    EXPECT_NEAR(length, 0.6, kRounding);
    // About its heel instead, then along itself, then on.
    stroke.poses = {{{0.2, y, 0.2}, {0.2, y, -0.2}},
                    {{0.2, y, 0.2}, {0.5, y, -0.2}},
                    {{0.275, y, 0.1}, {0.575, y, -0.3}},
                    {{1.3, y, 0.1}, {1.6, y, -0.3}}};
    EXPECT_NEAR(lengthOf(onlyPath(stroke, cloth)), 0.8, kRounding);
  }
}

/// Crossing points of folded, crumpled cloth lie on the swept surface, here a plane.
TEST(FindPaths, LiesOnTheSweptSurface) {
  const Cloth cloth = shapedCloth({33, 33, 1.0, 1.0}, [](const Vec3& p) {
    return Vec3(0.3 * std::sin(9.0 * p.x()), p.y() + 0.1 * std::cos(7.0 * p.x()),
                0.2 * std::cos(9.0 * p.x()) + 0.05 * std::sin(11.0 * p.y()));
  });
  const Stroke stroke = strokeAlong({{-0.9, 0.2, 0.0}, {0.8, 0.77, 0.1}}, {0.1, 0.2, 1.0}, 1.0);
  const Vec3 along = stroke.poses[1].heel - stroke.poses[0].heel;
  const Vec3 normal = along.cross(stroke.poses[0].tip - stroke.poses[0].heel).normalized();
  const auto paths = pathsOf(stroke, cloth);
  expectSound(paths, cloth.mesh);
  ASSERT_FALSE(paths.empty());
  for (const SurfacePath& path : paths) {
    for (const SurfacePoint& p : path.points) {
      EXPECT_NEAR(normal.dot(positionOf(cloth, p) - stroke.poses[0].heel), 0.0, kRounding);
    }
  }
}

/// A stroke along x over folded cloth, from above or from below.
Stroke overFold(bool fromAbove, bool firstLayerOnly) {
  Stroke stroke = drawn({{-0.5, 0.3}, {1.5, 0.3}});
  stroke.firstLayerOnly = firstLayerOnly;
  for (Blade& blade : stroke.poses) {
    if (!fromAbove) std::swap(blade.heel, blade.tip);
  }
  return stroke;
}

TEST(FirstLayer, IsWhatIsNearestToTheHeel) {
  const Cloth cloth = foldedCloth(0.5, 0.05);
  const SurfacePath both = onlyPath(overFold(true, false), cloth);
  EXPECT_NEAR(lengthOf(both), 1.0, kRounding);
  const SurfacePath upper = onlyPath(overFold(true, true), cloth);
  expectAt(upper.points.front(), {1.0, 0.3});
  expectAt(upper.points.back(), {0.5, 0.3});
  const SurfacePath lower = onlyPath(overFold(false, true), cloth);
  expectAt(lower.points.front(), {0.0, 0.3});
  expectAt(lower.points.back(), {0.5, 0.3});
}

TEST(FirstLayer, ChangesWhereTheNearestDoes) {
  const Cloth cloth = foldedCloth(0.625, 0.05);  // the upper layer begins at x = 1/4
  const auto paths = pathsOf(overFold(true, true), cloth);
  expectSound(paths, cloth.mesh);
  ASSERT_EQ(paths.size(), 2U);
  expectAt(paths[0].points.front(), {0.0, 0.3});
  expectAt(paths[0].points.back(), {0.25, 0.3});
  expectAt(paths[1].points.front(), {1.0, 0.3});
  expectAt(paths[1].points.back(), {0.625, 0.3});
}

TEST(FirstLayer, IsOneOfTwoThatTouch) {
  const Cloth cloth = foldedCloth(0.5, 0.0);
  const SurfacePath path = onlyPath(overFold(true, true), cloth);
  EXPECT_NEAR(lengthOf(path), 0.5, 1e-9);
}

TEST(FirstLayer, IsAllOfASingleLayer) {
  const Cloth cloth = shapedCloth({33, 9, 1.0, 1.0}, [](const Vec3& p) {
    return Vec3(p.x(), p.y(), 0.8 * (p.x() - 0.5) * (p.x() - 0.5));
  });
  const SurfacePath all = onlyPath(overFold(true, false), cloth);
  const SurfacePath first = onlyPath(overFold(true, true), cloth);
  ASSERT_EQ(first.points.size(), all.points.size());
  Stroke ring = drawn(circle(16));
  ring.firstLayerOnly = true;
  EXPECT_TRUE(onlyPath(ring, squareCloth()).isClosed());
}

/// Cloth that hangs in a V, cut by a level blade that rises and meets both sides at the same time.
TEST(FirstLayer, IsTheNearSideOfAHangingLoop) {
  const Cloth cloth = shapedCloth({17, 9, 1.0, 1.0}, [](const Vec3& p) {
    return Vec3(0.4 * (p.x() - 0.5), p.y(), std::abs(p.x() - 0.5));
  });
  Stroke stroke = strokeAlong({{0.0, 0.3, -0.2}, {0.0, 0.3, 0.8}}, Vec3::UnitX(), 0.5);
  EXPECT_NEAR(lengthOf(onlyPath(stroke, cloth)), 1.0, kRounding);
  stroke.firstLayerOnly = true;
  const SurfacePath near = onlyPath(stroke, cloth);
  expectAt(near.points.front(), {0.5, 0.3});
  expectAt(near.points.back(), {0.0, 0.3});
}

/// Returns whether a parallelogram of the swept surface crosses the edge {a, b}, and where; nothing
/// near the border of the parallelogram.
enum class Meets { kNo, kYes, kUnclear };
Meets meets(const Blade& from, const Blade& to, const Vec3& a, const Vec3& b, double& part) {
  Eigen::Matrix3d axes;
  axes << to.heel - from.heel, from.tip - from.heel, a - b;
  const Vec3 at = axes.inverse() * (a - from.heel);
  part = at.z();
  const double inside = std::min(at.minCoeff(), (Vec3::Ones() - at).minCoeff());
  if (!(std::abs(inside) > 1e-7)) return Meets::kUnclear;
  return inside > 0.0 ? Meets::kYes : Meets::kNo;
}

std::size_t pointsAt(const std::vector<SurfacePath>& paths, const Vec2& at) {
  std::size_t count = 0;
  for (const SurfacePath& path : paths) {
    const auto near = [&](const SurfacePoint& p) { return (p.material - at).norm() < 1e-9; };
    count += std::count_if(path.points.begin(), path.points.end(), near);
    if (path.isClosed() && near(path.points.back())) --count;  // the first point again
  }
  return count;
}

/// Every mesh edge that the swept surface crosses has one point per slice.
void expectComplete(const std::vector<SurfacePath>& paths, const Stroke& stroke,
                    const Cloth& cloth) {
  for (VertexId a = 0; a < cloth.mesh.vertexCount(); ++a) {
    for (VertexId b : cloth.mesh.neighbours(a)) {
      for (std::size_t k = 0; a < b && k + 1 < stroke.poses.size(); ++k) {
        double t = 0.0;
        const Meets answer = meets(stroke.poses[k], stroke.poses[k + 1], cloth.x[a], cloth.x[b], t);
        if (answer != Meets::kYes) continue;
        const Vec2 at = (1.0 - t) * cloth.mesh.material(a) + t * cloth.mesh.material(b);
        EXPECT_EQ(pointsAt(paths, at), 1U) << "edge " << a << " - " << b << ", slice " << k;
      }
    }
  }
}

TEST(FindPaths, CrossesEveryEdgeOnceOnRandomCloth) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Generator random(seed);
    const Cloth cloth = shapedCloth({12, 10, 1.0, 1.0}, [&](const Vec3& p) {
      const double shake = 0.06;  // folds over here and there
      return Vec3(p + Vec3(uniform(random, -shake, shake), uniform(random, -shake, shake),
                           uniform(random, -shake, shake)));
    });
    std::vector<Vec3> path;
    for (int k = 0; k < 2 + static_cast<int>(seed % 3); ++k) {
      path.emplace_back(uniform(random, -0.2, 1.2), uniform(random, -0.2, 1.2),
                        uniform(random, -0.03, 0.03));
    }
    const Vec3 direction(uniform(random, -0.7, 0.7), uniform(random, -0.7, 0.7), 1.0);
    const Stroke stroke = strokeAlong(path, direction, uniform(random, 0.05, 0.3));
    const auto paths = pathsOf(stroke, cloth);
    SCOPED_TRACE("seed " + std::to_string(seed));
    expectSound(paths, cloth.mesh);
    expectComplete(paths, stroke, cloth);
  }
}

/// Strokes whose corners and segments lie on vertices and edges wherever possible, and run back
/// over themselves, with exact and with rounded coordinates.
TEST(FindPaths, IsOnePathHoweverDegenerate) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Generator random(seed);
    const Cloth cloth = squareCloth(seed % 2 == 0 ? 9 : 8);
    std::vector<Vec2> path;
    double length = 0.0;
    while (path.size() < 6) {
      const auto place = [&] { return (1 + static_cast<int>(random() % 11)) * 0.5; };
      const Vec2 next = cloth.grid.spacingU() * Vec2(place(), place());
      if (!path.empty() && next == path.back()) continue;
      if (!path.empty()) length += (next - path.back()).norm();
      path.push_back(next);
    }
    SCOPED_TRACE("seed " + std::to_string(seed));
    const SurfacePath found = onlyPath(drawn(path), cloth);
    EXPECT_NEAR(lengthOf(found), length, 1e-11);  // some hundred points
    for (std::size_t k = 1; k + 1 < path.size(); ++k) {
      const Vec2 before = path[k] - path[k - 1];
      const Vec2 after = path[k + 1] - path[k];
      const bool straight = before.dot(after) > (1.0 - 1e-9) * before.norm() * after.norm();
      EXPECT_TRUE(straight || hasPointAt(found, path[k])) << k;
    }
    expectAt(found.points.front(), path.front());
    expectAt(found.points.back(), path.back());
  }
}

TEST(FindPaths, SurvivesPositionsThatAreNoNumbers) {
  Cloth cloth = squareCloth();
  cloth.x[cloth.grid.vertex(4, 4)].setConstant(std::nan(""));
  expectSound(pathsOf(drawn({{-0.5, 0.4}, {1.5, 0.45}}), cloth), cloth.mesh);
}

}  // namespace
}  // namespace cloth_sim
