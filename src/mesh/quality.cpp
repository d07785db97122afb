#include "quality.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cloth_sim {

double doubleArea(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y());
}

double minAngle(const Vec2& a, const Vec2& b, const Vec2& c) {
  // The smallest angle lies between the two longest edges: its sine is twice the area over their
  // product, and it is less than 60 degrees.
  const double ab = (b - a).squaredNorm();
  const double bc = (c - b).squaredNorm();
  const double ca = (a - c).squaredNorm();
  const double shortest = std::min({ab, bc, ca});
  const double product = shortest == ab ? bc * ca : (shortest == bc ? ab * ca : ab * bc);
  if (!(product > 0.0)) return 0.0;
  return std::asin(std::clamp(doubleArea(a, b, c) / std::sqrt(product), -1.0, 1.0));
}

double minAngle(const TriangleMesh& mesh, FaceId f) {
  const Face& face = mesh.face(f);
  return minAngle(mesh.material(face[0]), mesh.material(face[1]), mesh.material(face[2]));
}

double longestEdge(const TriangleMesh& mesh, FaceId f) {
  double squared = 0.0;
  for (int k = 0; k < 3; ++k) {
    const Vec2 edge = mesh.material(mesh.face(f)[(k + 1) % 3]) - mesh.material(mesh.face(f)[k]);
    squared = std::max(squared, edge.squaredNorm());
  }
  return std::sqrt(squared);
}

double shortestEdge(const TriangleMesh& mesh) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const Face& face : mesh.faces()) {
    for (int k = 0; k < 3; ++k) {
      const Vec2 edge = mesh.material(face[(k + 1) % 3]) - mesh.material(face[k]);
      shortest = std::min(shortest, edge.squaredNorm());
    }
  }
  return std::sqrt(shortest);
}

}  // namespace cloth_sim
