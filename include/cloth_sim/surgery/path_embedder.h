#pragma once
/// \file Embedding of a path over the surface into the edges of the mesh.

#include "cloth_sim/surgery/remesher.h"
#include "cloth_sim/surgery/stroke.h"

namespace cloth_sim {

/// A path as a polyline of mesh edges.
struct EmbeddedPath {
  std::vector<VertexId> vertices;  ///< consecutive ones are joined by a marked edge
  double length = 0.0;             ///< at rest [m]
  double deviation = 0.0;          ///< largest distance from the given path [m]
};

/// End of an embedded path.
enum class PathEnd {
  kExact,      ///< at its last point, inside a face if necessary
  kLastCross,  ///< at the last edge that it crosses
};

/// Edits the mesh so that `path` runs along edges, and marks them.
///
/// The path is traced from vertex to vertex: from the vertex that it has reached, it leaves the
/// surrounding faces through one of their outer edges. Either the nearer end of that edge moves
/// onto the crossing, or the edge is split there. A crossing within ShapeLimits::snap of a vertex
/// prefers the former, others prefer the latter; if the preferred edit makes poor faces, the edit
/// with the better angles is made. If neither is allowed, the path bends to the nearer end. Ends
/// and corners of the path become vertices in the same way.
EmbeddedPath embedPath(const SurfacePath& path, PathEnd end, Remesher& remesher);

/// Finds the face that contains `point.material`, by a breadth-first search from `point.face`.
/// \return the face, or the nearest one found within a limited number of faces.
FaceId locate(const TriangleMesh& mesh, const SurfacePoint& point);

}  // namespace cloth_sim
