#pragma once
/// \file Surfaces of triangles for tests.

#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <random>
#include <string>

#include "cloth_sim/contact/shapes/mesh.h"

namespace cloth_sim::testing_support {

/// Vertices and triangles of a surface.
struct SurfaceParts {
  std::vector<Vec3> vertices;
  std::vector<TriangleSurface::Triangle> triangles;

  TriangleSurface surface() const { return {vertices, triangles}; }
  MeshShape shape() const {
    MeshShape result;
    result.file = surfaceFile("test", surface());
    return result;
  }
};

/// An octahedron of which each triangle is divided by four `levels` times, on a sphere:
/// 8 * 4^levels triangles.
inline SurfaceParts ballOf(double radius, int levels) {
  SurfaceParts ball;
  ball.vertices = {Vec3::UnitX(),  -Vec3::UnitX(), Vec3::UnitY(),
                   -Vec3::UnitY(), Vec3::UnitZ(),  -Vec3::UnitZ()};
  ball.triangles = {{{0, 2, 4}}, {{2, 1, 4}}, {{1, 3, 4}}, {{3, 0, 4}},
                    {{2, 0, 5}}, {{1, 2, 5}}, {{3, 1, 5}}, {{0, 3, 5}}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [it, isNew] =
          middles.emplace(std::minmax(a, b), static_cast<int>(ball.vertices.size()));
      if (isNew) ball.vertices.push_back((ball.vertices[a] + ball.vertices[b]).normalized());
      return it->second;
    };
    std::vector<TriangleSurface::Triangle> finer;
    for (const auto& [a, b, c] : ball.triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{{a, ab, ca}}, {{ab, b, bc}}, {{ca, bc, c}}, {{ab, bc, ca}}});
    }
    ball.triangles = finer;
  }
  for (Vec3& x : ball.vertices) x *= radius;
  return ball;
}

/// A level rectangle around the origin, of 2 * columns * rows triangles.
inline SurfaceParts sheetOf(double width, double depth, int columns, int rows) {
  SurfaceParts sheet;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      sheet.vertices.emplace_back(width * (static_cast<double>(i) / columns - 0.5),
                                  depth * (static_cast<double>(j) / rows - 0.5), 0.0);
    }
  }
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const int a = j * (columns + 1) + i, c = a + columns + 1;
      sheet.triangles.insert(sheet.triangles.end(), {{{a, a + 1, c}}, {{a + 1, c + 1, c}}});
    }
  }
  return sheet;
}

/// A folder-less file with these contents, removed at the end.
class SurfaceTestFile {
 public:
  SurfaceTestFile(std::string name, const std::string& contents) : name_(std::move(name)) {
    std::ofstream(name_, std::ios::binary) << contents;
  }
  ~SurfaceTestFile() { std::remove(name_.c_str()); }
  SurfaceTestFile(const SurfaceTestFile&) = delete;
  SurfaceTestFile& operator=(const SurfaceTestFile&) = delete;
  const std::string& name() const { return name_; }

 private:
  std::string name_;
};

}  // namespace cloth_sim::testing_support
