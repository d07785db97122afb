/// \file Plate bending: exact for quadratics on any mesh, zero without bending, updated locally.

#include "cloth_sim/cloth/plate_bending.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kRigidity = 3e-5;

std::vector<Vec3> placed(const TriangleMesh& mesh, const std::function<Vec3(const Vec2&)>& where) {
  std::vector<Vec3> x;
  for (const Vec2& p : mesh.material()) x.push_back(where(p));
  return x;
}

/// Returns whether a face has three neighbours with different far corners: six points, which
/// determine a quadratic.
bool isInner(const TriangleMesh& mesh, FaceId f) {
  const Face& face = mesh.face(f);
  std::set<VertexId> corners;
  for (int k = 0; k < 3; ++k) {
    const std::array<FaceId, 2> sides = mesh.facesOnEdge(face[k], face[(k + 1) % 3]);
    if (sides[1] == kNone) return false;
    const FaceId other = sides[0] == f ? sides[1] : sides[0];
    corners.insert(mesh.oppositeVertex(other, face[k], face[(k + 1) % 3]));
  }
  return corners.size() == 3;
}

double squaredCurvature(const PlateBending& bending, FaceId f, const std::vector<Vec3>& x) {
  double sum = 0.0;
  for (int e = 3 * f; e < 3 * f + 3; ++e) {
    const PlateElement& element = bending.elements()[static_cast<std::size_t>(e)];
    Vec3 curvature = Vec3::Zero();
    for (int k = 0; k < element.count; ++k) {
      curvature += element.weight[static_cast<std::size_t>(k)] *
                   x[static_cast<std::size_t>(element.vertex[static_cast<std::size_t>(k)])];
    }
    sum += curvature.squaredNorm();
  }
  return sum;
}

TEST(PlateBending, HasNoElementsOnAFaceWithHardlyAnArea) {
  // Its inverse is not finite, with which Eigen's decomposition reads beyond the end of its arrays.
  const TriangleMesh mesh({Vec2(0.0, 0.0), Vec2(1e-160, 0.0), Vec2(0.0, 1e-160), Vec2(1.0, 1.0)},
                          {{0, 1, 2}, {2, 1, 3}});
  const PlateBending bending(mesh, kRigidity);
  for (std::size_t e = 0; e < 3; ++e) EXPECT_EQ(bending.elements()[e].count, 0);
  for (const PlateElement& element : bending.elements()) {
    for (const double weight : element.weight) EXPECT_TRUE(std::isfinite(weight));
  }
}

TEST(PlateBending, IsExactForQuadraticsOnIrregularMeshes) {
  Generator random(5);
  for (int trial = 0; trial < 10; ++trial) {
    TriangleMesh mesh = makeGridMesh({6, 7, 0.5, 0.7});
    MeshEditor editor(mesh);
    RandomEditor edits(editor, random);
    for (int k = 0; k < 3 * trial; ++k) edits.any();
    const PlateBending bending(mesh, kRigidity);
    const double a = uniform(random, -3, 3), b = uniform(random, -3, 3), c = uniform(random, -3, 3);
    const auto x = placed(mesh, [&](const Vec2& p) {
      const double z = 0.5 * a * p.x() * p.x() + 0.5 * b * p.y() * p.y() + c * p.x() * p.y();
      return Vec3(p.x() + 2.0, p.y() - 1.0, z + 0.3 * p.x());
    });
    const double exact = a * a + b * b + 2.0 * c * c;
    int inner = 0, determined = 0;
    for (FaceId f = 0; f < mesh.faceCount(); ++f) {
      const double found = squaredCurvature(bending, f, x);
      // Less where a neighbour is missing, never more than what the quadratic bends.
      EXPECT_LE(found, exact * (1.0 + 1e-6)) << "face " << f;
      if (!isInner(mesh, f)) continue;
      ++inner;
      determined += std::abs(found - exact) <= 1e-6 * exact ? 1 : 0;
    }
    // Six points on a conic say less: around some vertices of four faces.
    EXPECT_GT(inner, 10);
    EXPECT_GE(determined, inner - inner / 8) << "trial " << trial;
  }
}

TEST(PlateBending, HasTheStencilsOfFiniteDifferencesOnAGrid) {
  const double h = 0.1;
  const TriangleMesh mesh = makeGridMesh({6, 6, 5 * h, 5 * h});
  const PlateBending bending(mesh, kRigidity);
  int threads = 0, cells = 0;
  for (const PlateElement& element : bending.elements()) {
    if (element.count == 0) continue;
    EXPECT_NEAR(element.stiffness, kRigidity * 0.5 * h * h, 1e-9 * kRigidity * h * h);
    double largest = 0.0;
    for (double weight : element.weight) largest = std::max(largest, std::abs(weight));
    const bool thread = element.count == 3;
    EXPECT_TRUE(thread || element.count == 4) << element.count;
    EXPECT_NEAR(largest, (thread ? 2.0 : std::sqrt(2.0)) / (h * h), 1e-9 / (h * h));
    ++(thread ? threads : cells);
  }
  EXPECT_EQ(cells, 2 * 25) << "both faces of every cell tell its twist";
  EXPECT_EQ(threads, 2 * 2 * 5 * 4) << "all but the outermost faces have both sides of a thread";
}

TEST(PlateBending, RigidMotionAndUniformStretchCostNothing) {
  Generator random(6);
  TriangleMesh mesh = makeGridMesh({8, 8, 0.7, 0.7});
  MeshEditor editor(mesh);
  RandomEditor edits(editor, random);
  for (int k = 0; k < 10; ++k) edits.any();
  const PlateBending bending(mesh, kRigidity);
  const Eigen::AngleAxisd turn(0.7, Vec3(1, 2, 3).normalized());
  const auto x = placed(mesh, [&](const Vec2& p) {
    return Vec3(turn * Vec3(1.3 * p.x() + 0.2 * p.y(), 0.9 * p.y(), 0.0) + Vec3(1, 2, 3));
  });
  EXPECT_LT(bending.energy(x), 1e-18);
}

TEST(PlateBending, RollingACylinderCostsWhatAPlateSays) {
  // 1/2 B / R^2 per area, whichever way it is rolled, within what the border leaves out (a row and
  // a column of faces of 40) and the chords of the polygon, (h / R)^2 / 12.
  const int cells = 40;
  const double side = 0.4, radius = 0.08;
  const TriangleMesh mesh = makeGridMesh({cells + 1, cells + 1, side, side});
  const PlateBending bending(mesh, kRigidity);
  const double exact = 0.5 * kRigidity / (radius * radius) * side * side;
  for (const double angle : {0.0, 0.25 * M_PI, 0.5 * M_PI, 0.75 * M_PI, 0.4}) {
    const Vec2 along(std::cos(angle), std::sin(angle));
    const auto x = placed(mesh, [&](const Vec2& p) {
      const double s = along.dot(p), t = along.x() * p.y() - along.y() * p.x();
      return Vec3(radius * std::sin(s / radius), t, radius * std::cos(s / radius));
    });
    EXPECT_NEAR(bending.energy(x) / exact, 1.0, 0.05) << angle;
    EXPECT_LT(bending.energy(x), exact) << angle;
  }
}

TEST(PlateBendingChanges, GivesTheNetworkOfTheEditedMesh) {
  Generator random(12);
  for (int sequence = 0; sequence < 20; ++sequence) {
    TriangleMesh mesh = makeGridMesh({whole(random, 3, 7), whole(random, 3, 7), 0.7, 0.9});
    PlateBending bending(mesh, kRigidity);
    MeshEditor editor(mesh);
    RandomEditor edits(editor, random);
    for (int edit = 0; edit < 40; ++edit) {
      for (int k = whole(random, 1, 4); k > 0; --k) edits.any();
      bending.applyChanges(mesh, editor.finish());
      const PlateBending scratch(mesh, kRigidity);
      ASSERT_EQ(bending.elements().size(), scratch.elements().size());
      for (std::size_t e = 0; e < scratch.elements().size(); ++e) {
        const PlateElement& now = bending.elements()[e];
        const PlateElement& then = scratch.elements()[e];
        ASSERT_TRUE(now.vertex == then.vertex && now.weight == then.weight &&
                    now.stiffness == then.stiffness && now.count == then.count)
            << "sequence " << sequence << ", edit " << edit << ", face " << e / 3;
      }
    }
  }
}

}  // namespace
}  // namespace cloth_sim
