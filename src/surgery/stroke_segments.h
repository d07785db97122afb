#pragma once
/// \file From the crossings of a surface with single faces to paths over the cloth.

#include <array>

#include "swept_surface.h"

namespace cloth_sim {

/// What a point of a path is, so that faces and facets that share it can tell without looking at
/// coordinates: where the edge {a, b}, a < b, crosses a facet (a, b, facet), or where a edge
/// pierces a face (-1 - edge, face, 0).
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

/// Segments that follow on each other. The parameters of a point may differ between the segment
/// that ends and the one that starts there where a closed surface ends.
struct Polyline {
  std::vector<PathSegment> segments;
  bool closed = false;
};

/// One segment per facet and face that cross, in the order of the facets, without direction.
std::vector<PathSegment> crossFaces(const SweptSurface& surface, const TriangleMesh& mesh,
                                    const VertexData<Vec3>& positions);

/// Turns a polyline around unless it goes as the blade moves; where the blade reaches all of it at
/// once, from heel to tip.
void direct(Polyline& polyline);

/// Joins segments that share nodes, directs the polylines as the blade moves, and lets closed ones
/// start where the blade reaches them first. Segments of no length are left out.
std::vector<Polyline> joinSegments(const std::vector<PathSegment>& segments,
                                   const TriangleMesh& mesh);

/// Of all that the blade reaches at the same time, what is nearest to its heel; directed again.
std::vector<Polyline> lowerEnvelope(const std::vector<Polyline>& polylines);

/// The polylines' points in the order in which the blade reaches them, without those that are not
/// needed to stay within `tolerance` [m] of the line.
std::vector<SurfacePath> toPaths(std::vector<Polyline> polylines, double tolerance);

}  // namespace cloth_sim
