#pragma once
/// \file The intersection of a swept surface with a cloth: from segments in single faces to paths.

#include <array>

#include "swept_surface.h"

namespace cloth_sim {

/// Identifies a point of a path, so that neighbouring faces and facets agree on it without
/// comparing coordinates. It is (a, b, facet) where the mesh edge {a, b}, a < b, crosses a facet,
/// and
/// (-1 - edge, face, 0) where a facet edge pierces a face.
using PathNode = std::array<std::int32_t, 3>;

/// A point of a path.
struct PathSample {
  PathNode node{kNone, kNone, kNone};
  Vec2 material = Vec2::Zero();  ///< [m]
  Vec3 position = Vec3::Zero();  ///< in the world [m]
  SweptParameters at;
  Keep keep = Keep::kAlways;
};

/// A straight part of a path, within one face.
struct PathSegment {
  PathSample from, to;
  FaceId face = kNone;
};

/// Consecutive segments. Where a closed surface ends, the parameters of a point differ between the
/// segment that ends there and the one that starts there.
struct Polyline {
  std::vector<PathSegment> segments;
  bool closed = false;
};

/// Intersects a surface with the faces of a cloth.
/// \param positions  of the vertices, (vertexCount,) [m].
/// \return one segment per facet and face that cross, in the order of the facets, undirected.
std::vector<PathSegment> crossFaces(const SweptSurface& surface, const TriangleMesh& mesh,
                                    const VertexData<Vec3>& positions);

/// Reverses a polyline if it runs against the motion of the blade, or from the tip to the heel
/// where the blade reaches all of it at once.
void direct(Polyline& polyline);

/// Joins segments with common nodes to polylines in the direction of the stroke. Closed ones start
/// where the blade reaches them first. Segments without length are dropped.
std::vector<Polyline> joinSegments(const std::vector<PathSegment>& segments,
                                   const TriangleMesh& mesh);

/// Returns the parts of the polylines that are nearest to the heel among all that the blade reaches
/// at the same time: the lower envelope of blade over stroke parameter. Directed again.
std::vector<Polyline> lowerEnvelope(const std::vector<Polyline>& polylines);

/// Converts polylines to paths in the order in which the blade reaches their first points, and
/// drops points that are not needed to stay within `tolerance` [m].
std::vector<SurfacePath> toPaths(std::vector<Polyline> polylines, double tolerance);

}  // namespace cloth_sim
