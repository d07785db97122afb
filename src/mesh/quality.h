#pragma once
/// \file How good the shapes of faces are, in material coordinates.

#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// z of the cross product of two vectors in the plane.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Twice the signed area of a triangle: positive if counter-clockwise [m^2].
double doubleArea(const Vec2& a, const Vec2& b, const Vec2& c);

/// Smallest angle of a triangle [rad]; negative or zero if it is not counter-clockwise.
double minAngle(const Vec2& a, const Vec2& b, const Vec2& c);
double minAngle(const TriangleMesh& mesh, FaceId f);

/// Longest edge of a face at rest [m].
double longestEdge(const TriangleMesh& mesh, FaceId f);

/// Shortest edge of the mesh at rest [m].
double shortestEdge(const TriangleMesh& mesh);

}  // namespace cloth_sim
