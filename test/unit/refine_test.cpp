/// \file Refinement of a mesh near a path, and the neighbourhood of a path.

#include "cloth_sim/surgery/refine.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <numeric>

#include "surgery/nearest_point.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

// ---- nearest points -----------------------------------------------------------------------------

using Triangle = std::array<Vec3, 3>;

Triangle randomTriangle(Generator& random) {
  return {randomVector(random, 1.0), randomVector(random, 1.0), randomVector(random, 1.0)};
}

/// Returns the distance to the nearest of the points with barycentric coordinates k / n.
double sampledDistance(const Triangle& t, const Vec3& p, int n) {
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) {
      const Vec3 q = (i * t[0] + j * t[1] + (n - i - j) * t[2]) / n;
      nearest = std::min(nearest, (q - p).norm());
    }
  }
  return nearest;
}

double longestSide(const Triangle& t) {
  return std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
}

/// Returns the distance of p from the convex combination of the corners that fits it best.
double outside(const Triangle& t, const Vec3& p) {
  Eigen::Matrix<double, 4, 3> corners;
  for (int k = 0; k < 3; ++k) corners.col(k) << t[k], 1.0;
  const Vec3 weights = corners.colPivHouseholderQr().solve(p.homogeneous());
  const double off = (corners * weights - p.homogeneous()).norm();
  return std::max({off, -weights.minCoeff(), weights.maxCoeff() - 1.0});
}

TEST(NearestPoint, AgreesWithASearch) {
  Generator random(1);
  const int n = 40;
  for (int trial = 0; trial < 500; ++trial) {
    const Triangle t = randomTriangle(random);
    const Vec3 p = randomVector(random, 2.0);
    const Vec3 nearest = nearestPoint(t, p);
    const double distance = (nearest - p).norm();
    const double searched = sampledDistance(t, p, n);
    EXPECT_LE(distance, searched + 1e-12);
    EXPECT_GE(distance, searched - longestSide(t) / n) << "no point is farther from a sample";
    EXPECT_LT(outside(t, nearest), 1e-9);
  }
}

TEST(NearestPoint, OfAPointInTheTriangleIsItself) {
  Generator random(2);
  for (int trial = 0; trial < 100; ++trial) {
    const Triangle t = randomTriangle(random);
    const std::array<double, 3> weight = randomWeights(random, 0.01);
    const Vec3 p = weight[0] * t[0] + weight[1] * t[1] + weight[2] * t[2];
    EXPECT_LT((nearestPoint(t, p) - p).norm(), 1e-14);
    for (const Vec3& corner : t) EXPECT_LT((nearestPoint(t, corner) - corner).norm(), 1e-14);
  }
}

TEST(NearestPoint, OfWhatHasNoArea) {
  const Vec3 o = Vec3::Zero();
  const Vec3 x = Vec3::UnitX();
  EXPECT_EQ(nearestPoint({o, x, 2.0 * x}, Vec3(1.5, 1.0, 0.0)), Vec3(1.5, 0.0, 0.0));
  EXPECT_EQ(nearestPoint({o, o, x}, Vec3(0.25, 1.0, 0.0)), Vec3(0.25, 0.0, 0.0));
  EXPECT_EQ(nearestPoint({x, x, x}, Vec3(4.0, 1.0, 0.0)), x);
}

// ---- neighbourhoods -----------------------------------------------------------------------------

TEST(Neighbourhood, OfAPointIsABall) {
  Generator random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const Triangle t = randomTriangle(random);
    const Vec3 p = randomVector(random, 1.5);
    const double distance = (nearestPoint(t, p) - p).norm();
    if (distance < 1e-9) continue;
    EXPECT_TRUE(Neighbourhood({p}, 1.001 * distance).reaches(t));
    EXPECT_FALSE(Neighbourhood({p}, 0.999 * distance).reaches(t));
  }
}

TEST(Neighbourhood, OfAPathIsWithinAnEighthOfItsRadius) {
  // Samples are a quarter of the radius apart, so none of the path is farther than an eighth from
  // one of them.
  Generator random(4);
  int near = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Vec3> path;
    for (int k = whole(random, 2, 4); k > 0; --k) path.push_back(randomVector(random, 2.0));
    const Triangle t = randomTriangle(random);
    const double radius = uniform(random, 0.1, 0.6);
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k + 1 < path.size(); ++k) {
      for (int i = 0; i <= 400; ++i) {
        const Vec3 p = path[k] + (path[k + 1] - path[k]) * (i / 400.0);
        distance = std::min(distance, (nearestPoint(t, p) - p).norm());
      }
    }
    const bool reaches = Neighbourhood(path, radius).reaches(t);
    if (distance < 0.87 * radius) {
      EXPECT_TRUE(reaches) << trial;
    }
    if (distance > 1.1 * radius + 0.02) {
      EXPECT_FALSE(reaches) << trial;
    }
    near += reaches ? 1 : 0;
  }
  EXPECT_GT(near, 50);
  EXPECT_LT(near, 250);
}

TEST(Neighbourhood, OfAPathThatStandsStill) {
  const Triangle t{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const Vec3 p(0.2, 0.2, 0.5);
  EXPECT_TRUE(Neighbourhood({p, p, p}, 0.51).reaches(t));
  EXPECT_FALSE(Neighbourhood({p, p, p}, 0.49).reaches(t));
}

// ---- refining -----------------------------------------------------------------------------------

VertexData<Vec3> lifted(const TriangleMesh& mesh) {
  std::vector<Vec3> points;
  for (const Vec2& p : mesh.material()) points.emplace_back(p.x(), p.y(), 0.0);
  return VertexData<Vec3>(std::move(points), mesh.revision());
}

std::vector<FaceId> allFaces(const TriangleMesh& mesh) {
  std::vector<FaceId> faces(static_cast<std::size_t>(mesh.faceCount()));
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

Triangle placeOf(const TriangleMesh& mesh, FaceId f) {
  Triangle t;
  for (int k = 0; k < 3; ++k) t[k] << mesh.material(mesh.face(f)[k]), 0.0;
  return t;
}

constexpr std::int32_t kMany = 1 << 20;

/// Refines a flat cloth, and checks the invariants.
void refineFlat(const std::vector<Vec3>& path, const Refinement& refinement,
                const ShapeLimits& limits, TriangleMesh& mesh) {
  const double area = preciseArea(mesh);
  Remesher remesher(mesh, limits, {});
  const Neighbourhood near(path, refinement.radius);
  refineNear(near, refinement, lifted(mesh), allFaces(mesh), kMany, remesher);
  remesher.finish();
  EXPECT_EQ(validateMesh(mesh), "");
  EXPECT_TRUE(isConforming(mesh));
  EXPECT_NEAR(preciseArea(mesh), area, 1e-14 * area);
}

TEST(RefineNear, BringsWhatIsNearToItsGenerationAndLeavesTheRest) {
  const double h = 1.0 / 16.0;
  const double radius = 0.1;
  const std::vector<std::vector<Vec3>> paths{{Vec3(0.52, 0.47, 0.0)},
                                             {Vec3(0.2, 0.3, 0.0), Vec3(0.6, 0.35, 0.0)},
                                             {Vec3(0.0, 1.0, 0.0), Vec3(0.2, 0.8, 0.0)}};
  for (const std::vector<Vec3>& path : paths) {
    for (int generations : {0, 1, 2, 3, 5}) {
      TriangleMesh mesh = makeGridMesh({17, 17, 1.0, 1.0});
      const Refinement refinement{radius, generations, 0.0};
      refineFlat(path, refinement, {}, mesh);
      const Neighbourhood near(path, radius);
      // Bisections of neighbours reach out by two cells at most: each is of a larger face.
      const Neighbourhood around(path, radius + 3.0 * h);
      for (FaceId f = 0; f < mesh.faceCount(); ++f) {
        if (near.reaches(placeOf(mesh, f))) {
          EXPECT_GE(mesh.generation(f), generations);
        }
        if (!around.reaches(placeOf(mesh, f))) {
          EXPECT_EQ(mesh.generation(f), 0);
        }
        EXPECT_LE(mesh.generation(f), generations + 1) << "no more than conforming needs";
        EXPECT_NEAR(minAngle(mesh, f), M_PI / 4, 1e-12);
      }
      if (generations == 0) {
        EXPECT_EQ(mesh.revision(), 0U);
      }
    }
  }
}

TEST(RefineNear, MakesNoEdgeShorterThanItsOwnLimit) {
  // Edges are 1/8, then 0.088 (half a diagonal), 0.0625, 0.044, 0.031 ...
  TriangleMesh mesh = makeGridMesh({9, 9, 1.0, 1.0});
  refineFlat({Vec3(0.5, 0.5, 0.0)}, {0.2, 12, 0.04}, {}, mesh);
  EXPECT_NEAR(shortestEdge(mesh), std::sqrt(2.0) / 32.0, 1e-12);
}

TEST(RefineNear, MakesNoEdgeShorterThanTheLimits) {
  ShapeLimits limits;
  limits.minEdge = 0.06;
  TriangleMesh mesh = makeGridMesh({9, 9, 1.0, 1.0});
  refineFlat({Vec3(0.5, 0.5, 0.0)}, {0.2, 12, 0.01}, limits, mesh);
  EXPECT_NEAR(shortestEdge(mesh), 0.0625, 1e-12);
}

TEST(RefineNear, OfIrregularMeshesConformsAndKeepsHalfOfTheSmallestAngle) {
  Generator random(5);
  for (int trial = 0; trial < 20; ++trial) {
    TriangleMesh mesh = irregularMesh({8, 8, 1.0, 1.0}, 0.25, random);
    const double smallest = smallestAngle(mesh);
    const Vec3 p(uniform(random, 0.0, 1.0), uniform(random, 0.0, 1.0), 0.0);
    const Vec3 q(uniform(random, 0.0, 1.0), uniform(random, 0.0, 1.0), 0.0);
    ShapeLimits limits;
    limits.minAngle = 0.0;
    refineFlat({p, q}, {0.1, 4, 0.0}, limits, mesh);
    EXPECT_GE(smallestAngle(mesh), 0.5 * smallest - 1e-12);
    const Neighbourhood near({p, q}, 0.1);
    for (FaceId f = 0; f < mesh.faceCount(); ++f) {
      if (near.reaches(placeOf(mesh, f))) {
        EXPECT_GE(mesh.generation(f), 4);
      }
    }
  }
}

TEST(RefineNear, LooksWhereTheClothIsInTheWorld) {
  // Folded over u = 0.5, so that u = 0.25 and u = 0.75 are at the same place, 0.02 apart.
  TriangleMesh mesh = makeGridMesh({17, 17, 1.0, 1.0});
  std::vector<Vec3> folded;
  for (const Vec2& p : mesh.material()) {
    folded.emplace_back(std::min(p.x(), 1.0 - p.x()), p.y(), p.x() > 0.5 ? 0.02 : 0.0);
  }
  const auto refined = [&](double height, double radius) {
    TriangleMesh copy = mesh;
    Remesher remesher(copy, {}, {});
    const Vec3 point(0.25, 0.5, height);
    refineNear(Neighbourhood({point}, radius), {radius, 2, 0.0}, VertexData<Vec3>(folded),
               allFaces(copy), kMany, remesher);
    bool low = false;
    bool high = false;
    for (FaceId f = 0; f < copy.faceCount(); ++f) {
      if (copy.generation(f) == 0) continue;
      const double u = placeOf(copy, f)[0].x();
      low = low || std::abs(u - 0.25) < 0.2;
      high = high || std::abs(u - 0.75) < 0.2;
    }
    return std::pair(low, high);
  };
  EXPECT_EQ(refined(0.01, 0.05), std::pair(true, true));
  EXPECT_EQ(refined(-0.04, 0.05), std::pair(true, false));
  EXPECT_EQ(refined(0.06, 0.05), std::pair(false, true));
}

TEST(RefineNear, GoesOnFromTheSeedsOverWhatIsNear) {
  TriangleMesh mesh = makeGridMesh({17, 17, 1.0, 1.0});
  const std::vector<Vec3> path{Vec3(0.1, 0.5, 0.0), Vec3(0.9, 0.5, 0.0)};
  TriangleMesh fromAll = mesh;
  refineFlat(path, {0.05, 3, 0.0}, {}, fromAll);
  // One face at the one end of the path is enough to find all of it.
  FaceId seed = kNone;
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    if (Neighbourhood({path[0]}, 0.01).reaches(placeOf(mesh, f))) seed = f;
  }
  Remesher remesher(mesh, {}, {});
  refineNear(Neighbourhood(path, 0.05), {0.05, 3, 0.0}, lifted(mesh), {seed}, kMany, remesher);
  remesher.finish();
  const Neighbourhood near(path, 0.05);
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    if (near.reaches(placeOf(mesh, f))) {
      EXPECT_GE(mesh.generation(f), 3);
    }
  }
  EXPECT_EQ(mesh.faceCount(), fromAll.faceCount());
}

TEST(RefineNear, GivesUpAtTheMostVertices) {
  TriangleMesh mesh = makeGridMesh({17, 17, 1.0, 1.0});
  Remesher remesher(mesh, {}, {});
  refineNear(Neighbourhood({Vec3(0.5, 0.5, 0.0)}, 0.5), {0.5, 8, 0.0}, lifted(mesh), allFaces(mesh),
             400, remesher);
  remesher.finish();
  EXPECT_GT(mesh.vertexCount(), 400) << "so that the one who asked can tell";
  EXPECT_LT(mesh.vertexCount(), 400 + 64) << "one chain of bisections more";
  EXPECT_EQ(validateMesh(mesh), "");
  EXPECT_TRUE(isConforming(mesh));
}

TEST(RefineNear, FollowsEditsThatCameBefore) {
  // Coordinates are of the mesh as it is when refining begins, whatever the remesher did before.
  TriangleMesh mesh = makeGridMesh({9, 9, 1.0, 1.0});
  Remesher remesher(mesh, {}, {});
  ASSERT_TRUE(remesher.bisect(0));
  remesher.splitEdge(40, 41, 0.5 * (mesh.material(40) + mesh.material(41)));
  remesher.moveVertex(60, mesh.material(60) + Vec2(0.01, 0.01));
  refineNear(Neighbourhood({Vec3(0.5, 0.5, 0.0)}, 0.1), {0.1, 3, 0.0}, lifted(mesh), allFaces(mesh),
             kMany, remesher);
  remesher.finish();
  EXPECT_EQ(validateMesh(mesh), "");
  const Neighbourhood near({Vec3(0.5, 0.5, 0.0)}, 0.1);
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    if (near.reaches(placeOf(mesh, f))) {
      EXPECT_GE(mesh.generation(f), 3);
    }
  }
}

TEST(RefineNear, RequestsAreChecked) {
  RefineNear request;
  EXPECT_NE(validationError(request), "") << "no path";
  request.path = {Vec3::Zero()};
  request.refinement.radius = 0.1;
  EXPECT_EQ(validationError(request), "");
  for (double radius : {0.0, -1.0, HUGE_VAL, std::nan("")}) {
    RefineNear bad = request;
    bad.refinement.radius = radius;
    EXPECT_NE(validationError(bad), "") << radius;
  }
  for (int generations : {-1, kMostGenerations + 1}) {
    RefineNear bad = request;
    bad.refinement.generations = generations;
    EXPECT_NE(validationError(bad), "") << generations;
  }
  for (double minEdge : {-1e-9, HUGE_VAL, std::nan("")}) {
    RefineNear bad = request;
    bad.refinement.minEdge = minEdge;
    EXPECT_NE(validationError(bad), "") << minEdge;
  }
  RefineNear bad = request;
  bad.path.push_back(Vec3(0.0, std::nan(""), 0.0));
  EXPECT_NE(validationError(bad), "");
  for (const double far : {1e308, 1e9}) {  // it would take samples without number
    bad = request;
    bad.path = {Vec3::Zero(), Vec3(far, -far, 0.0)};
    EXPECT_NE(validationError(bad), "") << far;
  }
}

}  // namespace
}  // namespace cloth_sim
