#pragma once
/// \file The ruled surface that a moving blade sweeps, as triangles.

#include <array>

#include "cloth_sim/surgery/stroke.h"

namespace cloth_sim {

/// Tells whether the simplification of a path keeps a point.
enum class Keep : std::uint8_t {
  kNever,   ///< no: the point only exists because the surface consists of triangles
  kIfFar,   ///< if the path without it would exceed the tolerance
  kAlways,  ///< yes: the path turns or ends there, or crosses a mesh edge
};

/// An edge of facets: a pose of the blade, the diagonal of a slice, or a part of one of the two
/// rails along which the ends of the blade move.
struct FacetEdge {
  Vec3 from = Vec3::Zero();   ///< [m]
  Vec3 to = Vec3::Zero();     ///< [m]
  Keep keep = Keep::kAlways;  ///< of the points at which paths cross it
};

/// A triangle of the surface. Its edge k runs from corner k to the next corner. Edges with the same
/// number lie on one line: a blade that slides along itself keeps one edge.
struct SweptFacet {
  std::array<Vec3, 3> corners;                             ///< [m]
  std::array<std::int32_t, 3> edges{kNone, kNone, kNone};  ///< indices into SweptSurface::edges
  Vec3 normal = Vec3::Zero();                              ///< its length is twice the area [m^2]
  double length = 0.0;                                     ///< of the longest edge [m]
};

/// A part of the surface between two poses of the blade, flat up to the tolerance.
struct SweptSlice {
  Blade first, last;
  /// Sum of the normals of all facets. A single one, so that the stroke parameter is continuous.
  Vec3 normal = Vec3::Zero();
  double start = 0.0;  ///< stroke parameter at `first`, see SweptParameters
  double end = 0.0;    ///< stroke parameter at `last`
  std::int32_t firstEdge = kNone;
  std::int32_t lastEdge = kNone;
  std::int32_t firstFacet = 0;
  std::int32_t lastFacet = 0;  ///< one past the last
};

/// A surface of triangles. Neighbouring facets share the corners and the number of their common
/// edge. If the stroke ends with its first pose, the surface is closed: its last edge is the first.
struct SweptSurface {
  std::vector<SweptSlice> slices;
  std::vector<SweptFacet> facets;
  std::vector<FacetEdge> edges;
  double tolerance = 0.0;  ///< upper bound on the distance of facets from the ruled surface [m]
};

/// Makes the surface that the blade of a stroke sweeps.
SweptSurface makeSweptSurface(const Stroke& stroke);

/// Coordinates on the surface: when the blade passes a point, and at which point of the blade.
struct SweptParameters {
  double stroke = 0.0;  ///< index of a pose, plus the fraction of the way to the next
  double blade = 0.0;   ///< 0 at the heel, 1 at the tip
};

/// Returns the parameters of a point of a slice.
SweptParameters parametersAt(const SweptSlice& slice, const Vec3& point);
/// Returns the parameters of a point on the first blade of a slice.
SweptParameters parametersAtFirst(const SweptSlice& slice, const Vec3& point);
/// Returns the parameters of a point on the last blade of a slice.
SweptParameters parametersAtLast(const SweptSlice& slice, const Vec3& point);

}  // namespace cloth_sim
