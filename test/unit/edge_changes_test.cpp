/// \file The quick check of gradients by the edges of faces.

#include "contact/edge_changes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>

#include "cloth_sim/scene/build.h"

namespace cloth_sim {
namespace {

constexpr double kCell = 0.01;

/// A grid whose vertices are moved in the material plane by up to `jitter` cells.
TriangleMesh gridMesh(int columns, int rows, double jitter, std::mt19937& generator) {
  ClothSpec cloth;
  cloth.columns = columns;
  cloth.rows = rows;
  cloth.width = kCell * (columns - 1);
  cloth.height = kCell * (rows - 1);
  cloth.fabric = fabricPreset("cotton");
  const TriangleMesh grid = buildModel(cloth).mesh;
  std::uniform_real_distribution<double> uniform(-jitter * kCell, jitter * kCell);
  std::vector<Vec2> material;
  for (VertexId v = 0; v < grid.vertexCount(); ++v) {
    const double u = uniform(generator);
    material.push_back(grid.material(v) + Vec2(u, uniform(generator)));
  }
  return TriangleMesh(std::move(material), grid.faces());
}

/// Change of a face's gradient by motion of its corners (Frobenius norm).
double turnOf(const TriangleMesh& mesh, FaceId f, const VectorArray& moved,
              const std::vector<std::int32_t>& slots) {
  const Face& face = mesh.face(f);
  Eigen::Matrix2d rest;
  Eigen::Matrix<double, 3, 2> change;
  for (int k = 0; k < 2; ++k) {
    rest.col(k) = mesh.material(face[k + 1]) - mesh.material(face[0]);
    change.col(k) = moved.at(slots[face[k + 1]]) - moved.at(slots[face[0]]);
  }
  return (change * rest.inverse()).norm();
}

std::vector<std::int32_t> slotsFrom(std::int32_t first, const TriangleMesh& mesh) {
  std::vector<std::int32_t> slots(static_cast<std::size_t>(mesh.vertexCount()));
  std::iota(slots.begin(), slots.end(), first);
  return slots;
}

std::vector<GradientBall> ballsOf(double radius, const TriangleMesh& mesh) {
  std::vector<GradientBall> balls(static_cast<std::size_t>(mesh.faceCount()));
  for (GradientBall& ball : balls) ball.radius = radius;
  return balls;
}

/// Edges of a mesh whose vertices are in slots of their own number; gradients may turn by 0.1.
EdgeChanges edgesOf(const TriangleMesh& mesh) {
  EdgeChanges edges;
  edges.build(mesh);
  edges.follow(slotsFrom(0, mesh));
  edges.allow(ballsOf(0.1, mesh));
  return edges;
}

std::set<FaceId> changedFaces(const EdgeChanges& edges, const VectorArray& moved) {
  std::set<FaceId> faces;
  edges.visitChanged(moved, 0, edges.runCount(), [&](FaceId f) {
    faces.insert(f);
    return true;
  });
  return faces;
}

TEST(EdgeChanges, MissNoGradientThatLeavesItsBall) {
  std::mt19937 generator(5);
  const TriangleMesh mesh = gridMesh(19, 14, 0.3, generator);
  const auto vertices = static_cast<std::size_t>(mesh.vertexCount());
  std::vector<std::int32_t> slots = slotsFrom(3, mesh);
  EdgeChanges edges;
  edges.build(mesh);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::size_t left = 0;
  std::size_t spared = 0;
  for (int round = 0; round < 100; ++round) {
    if (round % 10 == 5) std::shuffle(slots.begin(), slots.end(), generator);
    if (round % 10 == 0) std::sort(slots.begin(), slots.end());
    edges.follow(slots);
    std::vector<GradientBall> balls = ballsOf(0.2, mesh);
    for (GradientBall& ball : balls) ball.radius += 0.1 * uniform(generator);
    edges.allow(balls);
    VectorArray moved;
    moved.resize(vertices + 3);
    const double far = 0.1 * kCell * std::abs(uniform(generator));
    for (const std::int32_t slot : slots) {
      const double x = uniform(generator);
      const double y = uniform(generator);
      moved.set(static_cast<std::size_t>(slot), far * Vec3(x, y, uniform(generator)));
    }
    const std::set<FaceId> changed = changedFaces(edges, moved);
    for (FaceId f = 0; f < mesh.faceCount(); ++f) {
      const bool hasLeft = turnOf(mesh, f, moved, slots) > balls[f].radius;
      left += hasLeft ? 1 : 0;
      spared += changed.count(f) == 0 ? 1 : 0;
      EXPECT_TRUE(!hasLeft || changed.count(f) == 1) << "round " << round << ", face " << f;
    }
  }
  EXPECT_GT(left, 1000U);
  EXPECT_GT(spared, 1000U);
}

/// Two faces share each edge along a thread, and the diagonals do not count.
TEST(EdgeChanges, OfAGridAreRowsAndColumnsInRuns) {
  std::mt19937 generator(6);
  const TriangleMesh mesh = gridMesh(20, 10, 0.0, generator);
  const EdgeChanges edges = edgesOf(mesh);
  EXPECT_EQ(edges.runCount(), 10 + 1);  // a run for each row, one for all columns
  VectorArray moved;
  moved.resize(200);
  const double allowed = 0.1 * kCell / std::sqrt(2.0);
  moved.set(47, Vec3(0.0, 0.0, 0.99 * allowed));
  EXPECT_TRUE(changedFaces(edges, moved).empty());
  moved.set(47, Vec3(0.0, 0.0, 1.01 * allowed));
  const std::set<FaceId> changed = changedFaces(edges, moved);
  for (const FaceId f : mesh.facesAround(47)) EXPECT_EQ(changed.count(f), 1U) << f;
}

TEST(EdgeChanges, CountWhereMotionIsNoNumberOrAFaceIsDistrusted) {
  std::mt19937 generator(7);
  const TriangleMesh mesh = gridMesh(9, 8, 0.2, generator);
  EdgeChanges edges = edgesOf(mesh);
  VectorArray moved;
  moved.resize(72);
  EXPECT_TRUE(changedFaces(edges, moved).empty());
  edges.distrust(31);
  EXPECT_EQ(changedFaces(edges, moved).count(31), 1U);
  edges.allow(ballsOf(0.1, mesh));
  EXPECT_TRUE(changedFaces(edges, moved).empty());
  moved.set(71, Vec3(0.0, std::numeric_limits<double>::quiet_NaN(), 0.0));
  const std::set<FaceId> changed = changedFaces(edges, moved);
  const auto around = mesh.facesAround(71);
  EXPECT_TRUE(
      std::any_of(around.begin(), around.end(), [&](FaceId f) { return changed.count(f) == 1; }));
}

}  // namespace
}  // namespace cloth_sim
