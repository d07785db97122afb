#pragma once
/// \file Closest points of points, segments and triangles, and directions that separate triangles.

#include <array>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// The corners of a triangle in the world, (3,) [m].
using Corners = std::array<Vec3, 3>;

/// Returns the barycentric coordinates of the point of a triangle that is closest to `p` (Ericson
/// 2005, Real-Time Collision Detection, 5.1.5). They are >= 0 and sum to 1; a coordinate is exactly
/// 0 if the point lies on the opposite side. A degenerate triangle counts as its longest side.
std::array<double, 3> closestOnTriangle(const Vec3& p, const Corners& triangle);

/// Angle between the sides of a triangle at one of its corners [rad].
double angleAt(const Vec3& corner, const Vec3& a, const Vec3& b);

/// The closest points a0 + s (a1 - a0) and b0 + t (b1 - b0) of two segments, s and t in [0, 1].
struct SegmentPoints {
  double s = 0.0;
  double t = 0.0;
};
/// Finds them (Ericson 2005, 5.1.9). Of parallel segments it returns one of the closest pairs.
SegmentPoints closestOnSegments(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1);

/// A direction and how far two sets of points are apart along it.
struct SeparatingDirection {
  Vec3 direction = Vec3::Zero();  ///< unit vector from the second set to the first; 0: none found
  double distance = 0.0;          ///< [m]; <= 0: not separated
};

/// Finds the direction in which two triangles are farthest apart: that of their closest points. The
/// distance is 0 if they touch or intersect.
SeparatingDirection separate(const Corners& a, const Corners& b);

/// Finds a unit vector n with n.a > 0 for both edges of one triangle and n.b < 0 for both edges of
/// another that share the vertex from which the edges start; `distance` is the least of |n.edge|.
/// It exists, by the theorem of separating cones, if the triangles touch in that vertex only.
SeparatingDirection separateAtVertex(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b);

/// The same for two triangles with a common edge, each with one more corner: a unit vector normal
/// to the edge. All vectors start from one end of the edge.
SeparatingDirection separateHinge(const Vec3& edge, const Vec3& a, const Vec3& b);

}  // namespace cloth_sim
