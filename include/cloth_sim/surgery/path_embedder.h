#pragma once
/// \file Makes a path over the surface run along mesh edges.

#include "cloth_sim/surgery/remesher.h"
#include "cloth_sim/surgery/stroke.h"

namespace cloth_sim {

/// What became of a path.
struct EmbeddedPath {
  std::vector<VertexId> vertices;  ///< consecutive ones are joined by marked edges
  double length = 0.0;             ///< of the chain at rest [m]
  double deviation = 0.0;          ///< farthest that the chain was bent away from the path [m]
};

/// How a path ends.
enum class PathEnd {
  kExact,      ///< at its last point, in the middle of a face if need be
  kLastCross,  ///< at the last edge that it crosses
};

/// Marks edges along `path`, and edits the mesh so that they lie on it.
///
/// The path is followed from star to star: from the vertex that it has reached, it leaves the faces
/// around that vertex through one of their outer edges. There the nearer end of the edge moves onto
/// the crossing, or the edge is split at it, whichever makes the better faces (the vertex, if the
/// crossing is within ShapeLimits::snap of it); if neither is allowed, the path bends to the nearer
/// end. Ends and corners of the path become vertices in the same way.
EmbeddedPath embedPath(const SurfacePath& path, PathEnd end, Remesher& remesher);

/// The face that has `point.material`, searched from `point.face` over edges, or the nearest one
/// found.
FaceId locate(const TriangleMesh& mesh, const SurfacePoint& point);

}  // namespace cloth_sim
