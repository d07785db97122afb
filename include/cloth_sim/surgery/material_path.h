#pragma once
/// \file Polylines in material coordinates: sides, distances and crossings.

#include <Eigen/Geometry>
#include <array>

#include "cloth_sim/mesh/triangle_mesh.h"
#include "cloth_sim/mesh/vertex_data.h"

namespace cloth_sim {

/// A polyline in material coordinates [m].
using MaterialPath = std::vector<Vec2>;

/// Returns a point of the material plane as a point (u, v, 0) of space [m].
inline Vec3 inMaterialPlane(const Vec2& p) { return Vec3(p.x(), p.y(), 0.0); }
/// Returns the material coordinates (u, v, 0) of all vertices, (vertexCount,) [m].
VertexData<Vec3> inMaterialPlane(const TriangleMesh& mesh);

/// Returns the signed distance of a point from the line of the nearest segment of `path` [m],
/// positive to the right of its direction. Distances of at most 1e-9 m are returned as 0.
double sideOf(const MaterialPath& path, const Vec2& point);

/// Returns the distance of a point to `path` [m].
double distanceTo(const MaterialPath& path, const Vec2& point);

/// Returns whether p and q lie on different sides of a segment of `path` that p-q crosses or
/// touches. A point within 1e-9 m of the line of the segment is on neither side.
bool separates(const MaterialPath& path, const Vec2& p, const Vec2& q);

/// A path with bounding boxes around groups of its segments, for many queries.
class PathIndex {
 public:
  explicit PathIndex(MaterialPath path);
  /// Same as the function `separates`.
  bool separates(const Vec2& p, const Vec2& q) const;

 private:
  MaterialPath path_;
  std::vector<Eigen::AlignedBox2d> boxes_;  ///< of consecutive groups of segments
};

/// Returns whether the segment p-q crosses or touches `path`, within 1e-9 m.
bool crosses(const MaterialPath& path, const Vec2& p, const Vec2& q);

}  // namespace cloth_sim
