#pragma once
/// \file The position of cuts and tears, and the areas of pieces.

#include "cloth_sim/scene/build.h"
#include "cloth_sim/surgery/material_path.h"
#include "cloth_sim/surgery/operation.h"
#include "unit/core_support.h"

namespace cloth_sim::surgery_support {

/// Returns the area of the part of a polygon to the left of the line through `p` along `d` [m^2].
inline double areaLeftOf(const std::vector<Vec2>& polygon, const Vec2& p, const Vec2& d) {
  const auto height = [&](const Vec2& q) {
    return d.x() * (q.y() - p.y()) - d.y() * (q.x() - p.x());
  };
  std::vector<Vec2> left;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2& a = polygon[k];
    const Vec2& b = polygon[(k + 1) % polygon.size()];
    const double ha = height(a);
    const double hb = height(b);
    if (ha >= 0.0) left.push_back(a);
    if (ha * hb < 0.0) left.push_back(a + ha / (ha - hb) * (b - a));
  }
  double twice = 0.0;
  for (std::size_t k = 0; k < left.size(); ++k) {
    const Vec2& a = left[k];
    const Vec2& b = left[(k + 1) % left.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

inline std::vector<Vec2> rectangle(double width, double height) {
  return {{0.0, 0.0}, {width, 0.0}, {width, height}, {0.0, height}};
}

/// A border edge along which the surface opened, with its ends at rest [m].
struct TornEdge {
  VertexId a = kNone;
  VertexId b = kNone;
  Vec2 from = Vec2::Zero();
  Vec2 to = Vec2::Zero();
};

inline std::vector<TornEdge> tornEdges(const TriangleMesh& mesh) {
  std::vector<TornEdge> edges;
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const VertexId a = mesh.face(f)[k];
      const VertexId b = mesh.face(f)[(k + 1) % 3];
      if (mesh.facesOnEdge(a, b)[1] != kNone || mesh.isOriginalBoundary(f, k)) continue;
      edges.push_back({a, b, mesh.material(a), mesh.material(b)});
    }
  }
  return edges;
}

/// Returns the largest distance of an end of a torn edge from a line [m].
inline double farthestFrom(const MaterialPath& line, const TriangleMesh& mesh) {
  double farthest = 0.0;
  for (const TornEdge& edge : tornEdges(mesh)) {
    farthest = std::max({farthest, distanceTo(line, edge.from), distanceTo(line, edge.to)});
  }
  return farthest;
}

/// Returns the smallest distance of an end of a torn edge from a point [m].
inline double nearestTo(const Vec2& p, const TriangleMesh& mesh) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const TornEdge& edge : tornEdges(mesh)) {
    nearest = std::min({nearest, (edge.from - p).norm(), (edge.to - p).norm()});
  }
  return nearest;
}

/// Returns the rest areas of the connected components, ascending [m^2].
inline std::vector<double> sortedAreas(const TriangleMesh& mesh) {
  std::vector<double> areas = testing_support::pieceAreas(mesh);
  std::sort(areas.begin(), areas.end());
  return areas;
}

/// Returns the limits of a scene without `surgery`.
inline SurgeryLimits usualLimits(const TriangleMesh& mesh) {
  SurgeryLimits limits;
  limits.shape.minEdge = 0.05 * shortestEdge(mesh);
  return limits;
}

}  // namespace cloth_sim::surgery_support
