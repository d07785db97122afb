#pragma once
/// \file Which side of a path things are on, in material coordinates.

#include <Eigen/Geometry>
#include <array>

#include "cloth_sim/mesh/triangle_mesh.h"
#include "cloth_sim/mesh/vertex_data.h"

namespace cloth_sim {

/// A polyline in material coordinates [m].
using MaterialPath = std::vector<Vec2>;

/// A place, or a whole cloth, in material coordinates as if it lay in the world's plane z = 0 [m].
inline Vec3 inMaterialPlane(const Vec2& p) { return Vec3(p.x(), p.y(), 0.0); }
VertexData<Vec3> inMaterialPlane(const TriangleMesh& mesh);

/// Signed distance to the nearest segment of `path`: positive to the right of its direction, and
/// beyond its ends measured from the end segments' lines [m]. Points within 1e-9 m count as right.
double sideOf(const MaterialPath& path, const Vec2& point);

/// Distance to `path` [m].
double distanceTo(const MaterialPath& path, const Vec2& point);

/// Whether p and q lie on different sides of some segment of `path` (neither nearer to its line
/// than 1e-9 m) that p-q crosses or touches.
bool separates(const MaterialPath& path, const Vec2& p, const Vec2& q);

/// A path that is asked for many segments.
class PathIndex {
 public:
  explicit PathIndex(MaterialPath path);
  /// As the function `separates`.
  bool separates(const Vec2& p, const Vec2& q) const;

 private:
  MaterialPath path_;
  std::vector<Eigen::AlignedBox2d> boxes_;  ///< of so many segments each, in their order
};

/// Whether the segment p-q meets `path` (touching counts, within 1e-9 m).
bool crosses(const MaterialPath& path, const Vec2& p, const Vec2& q);

}  // namespace cloth_sim
