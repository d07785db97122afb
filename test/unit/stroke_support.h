#pragma once
/// \file Cloths, strokes, and the invariants of paths.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "cloth_sim/mesh/grid.h"
#include "cloth_sim/surgery/stroke.h"

namespace cloth_sim::stroke_support {

constexpr double kPi = 3.141592653589793;
/// Tolerance for rounding errors of coordinates of about one metre, with a margin.
constexpr double kRounding = 1e-12;

struct Cloth {
  Grid grid;
  TriangleMesh mesh;
  VertexData<Vec3> x;
};

/// Returns the cloth in z = 0, with x = u and y = v.
inline Cloth flatCloth(const Grid& grid) {
  Cloth cloth{grid, makeGridMesh(grid), {}};
  cloth.x = VertexData<Vec3>(static_cast<std::size_t>(cloth.mesh.vertexCount()), Vec3::Zero());
  for (VertexId v = 0; v < cloth.mesh.vertexCount(); ++v) {
    cloth.x[v].head<2>() = cloth.mesh.material(v);
  }
  return cloth;
}

/// Returns a grid of 1 m x 1 m; with 9 x 9 vertices every coordinate is exact.
inline Cloth squareCloth(int count = 9) { return flatCloth({count, count, 1.0, 1.0}); }

/// Returns the cloth with each vertex at the position that `shape` gives.
template <typename Shape>
inline Cloth shapedCloth(const Grid& grid, const Shape& shape) {
  Cloth cloth = flatCloth(grid);
  for (Vec3& p : cloth.x) p = shape(Vec3(p));
  return cloth;
}

inline Stroke drawn(const std::vector<Vec2>& path, double reach = 0.25) {
  std::vector<Vec3> points;
  for (const Vec2& p : path) points.emplace_back(p.x(), p.y(), 0.0);
  return strokeAlong(points, -Vec3::UnitZ(), reach);
}

inline std::vector<SurfacePath> pathsOf(const Stroke& stroke, const Cloth& cloth) {
  return findPaths(stroke, cloth.mesh, cloth.x);
}

/// Returns the barycentric coordinates of a point in a face.
inline Vec3 weightsIn(const TriangleMesh& mesh, FaceId f, const Vec2& p) {
  const auto& [a, b, c] = mesh.face(f);
  Eigen::Matrix2d edges;
  edges << mesh.material(b) - mesh.material(a), mesh.material(c) - mesh.material(a);
  const Vec2 w = edges.inverse() * (p - mesh.material(a));
  return {1.0 - w.x() - w.y(), w.x(), w.y()};
}

inline bool liesIn(const TriangleMesh& mesh, FaceId f, const Vec2& p) {
  return weightsIn(mesh, f, p).minCoeff() > -kRounding;
}

/// Checks that every segment of a path has a length and lies in the face of its first point.
inline void expectSound(const std::vector<SurfacePath>& paths, const TriangleMesh& mesh) {
  for (const SurfacePath& path : paths) {
    ASSERT_GE(path.points.size(), 2U);
    for (std::size_t k = 0; k + 1 < path.points.size(); ++k) {
      const SurfacePoint& p = path.points[k];
      EXPECT_TRUE(liesIn(mesh, p.face, p.material)) << k << ": " << p.material.transpose();
      EXPECT_TRUE(liesIn(mesh, p.face, path.points[k + 1].material)) << k;
      EXPECT_NE(p.material, path.points[k + 1].material) << k;
    }
    EXPECT_TRUE(liesIn(mesh, path.points.back().face, path.points.back().material));
  }
}

inline void expectAt(const SurfacePoint& point, const Vec2& material) {
  EXPECT_LT((point.material - material).norm(), kRounding) << point.material.transpose();
}

inline double lengthOf(const SurfacePath& path) {
  double length = 0.0;
  for (std::size_t k = 0; k + 1 < path.points.size(); ++k) {
    length += (path.points[k + 1].material - path.points[k].material).norm();
  }
  return length;
}

inline bool hasPointAt(const SurfacePath& path, const Vec2& at) {
  return std::any_of(path.points.begin(), path.points.end(),
                     [&](const SurfacePoint& p) { return (p.material - at).norm() < kRounding; });
}

/// Checks that the stroke cuts the cloth along one path from `first` to `last`.
inline SurfacePath onlyPath(const Stroke& stroke, const Cloth& cloth) {
  const std::vector<SurfacePath> paths = pathsOf(stroke, cloth);
  expectSound(paths, cloth.mesh);
  EXPECT_EQ(paths.size(), 1U);
  return paths.size() == 1 ? paths.front() : SurfacePath{{{0, {0, 0}}, {0, {0, 0}}}};
}

inline std::vector<Vec2> circle(int count) {
  std::vector<Vec2> points;
  for (int k = 0; k <= count; ++k) {
    const double angle = 2.0 * kPi * (k % count) / count;
    points.emplace_back(0.51 + 0.3 * std::cos(angle), 0.49 + 0.3 * std::sin(angle));
  }
  return points;
}

}  // namespace cloth_sim::stroke_support
