#pragma once
/// \file Areas, angles and edges of faces at rest: measures of their quality.

#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// Returns the z component of the cross product of two vectors in the plane.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Returns twice the signed area of a triangle [m^2], positive if it is counter-clockwise.
double doubleArea(const Vec2& a, const Vec2& b, const Vec2& c);

/// Returns the smallest angle of a triangle [rad]; zero or negative if it is not counter-clockwise.
double minAngle(const Vec2& a, const Vec2& b, const Vec2& c);
double minAngle(const TriangleMesh& mesh, FaceId f);

/// Returns the length of the longest edge of a face at rest [m].
double longestEdge(const TriangleMesh& mesh, FaceId f);

/// Returns the length of the shortest edge of the mesh at rest [m].
double shortestEdge(const TriangleMesh& mesh);

}  // namespace cloth_sim
