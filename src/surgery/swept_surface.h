#pragma once
/// \file What a blade sweeps, as a surface of triangles.

#include <array>

#include "cloth_sim/surgery/stroke.h"

namespace cloth_sim {

/// Whether a path has to have some point.
enum class Keep : std::uint8_t {
  kNever,   ///< it is an artefact of how the surface is made of facets
  kIfFar,   ///< if the path would be too far from it otherwise
  kAlways,  ///< the path turns or ends there, or crosses an edge
};

/// A line at which facets of a surface end: a pose of the blade, the diagonal of a slice, or one of
/// the surface's two rails.
struct SweptEdge {
  Vec3 from = Vec3::Zero();
  Vec3 to = Vec3::Zero();
  Keep keep = Keep::kAlways;  ///< of a point where a path crosses it
};

/// A triangle of a surface. Its edge k runs from corner k to the next one. All edges of one
/// number lie on one line: that of a blade that slid along itself has a single number.
struct SweptFacet {
  std::array<Vec3, 3> corners;
  std::array<std::int32_t, 3> edges{kNone, kNone, kNone};
  Vec3 normal = Vec3::Zero();  ///< of twice the facet's area in length [m^2]
  double length = 0.0;         ///< of the longest edge [m]
};

/// The part of a surface between two poses of the blade.
struct SweptSlice {
  Blade first, last;
  Vec3 normal = Vec3::Zero();  ///< of any length: one for all facets, so that time is continuous
  double start = 0.0;  ///< stroke parameter at `first`: the index of a pose and the part of the way
  double end = 0.0;    ///< at `last`
  std::int32_t firstEdge = kNone;
  std::int32_t lastEdge = kNone;
  std::int32_t firstFacet = 0;
  std::int32_t lastFacet = 0;  ///< one past
};

/// Neighbouring facets share the corners and the number of the edge between them. The surface is
/// closed if the stroke ends with the pose it began with: its first edge is the last, too.
struct SweptSurface {
  std::vector<SweptSlice> slices;
  std::vector<SweptFacet> facets;
  std::vector<SweptEdge> edges;
  double tolerance = 0.0;  ///< how far facets are from the ruled surface, at most, or more [m]
};

SweptSurface makeSweptSurface(const Stroke& stroke);

/// When the blade passes a point of the surface, and where on the blade.
struct SweptParameters {
  double stroke = 0.0;  ///< the index of a pose, and the part of the way to the next
  double blade = 0.0;   ///< 0 at the heel, 1 at the tip
};

SweptParameters parametersAt(const SweptSlice& slice, const Vec3& point);
/// Of a point on the slice's first or last blade.
SweptParameters parametersAtFirst(const SweptSlice& slice, const Vec3& point);
SweptParameters parametersAtLast(const SweptSlice& slice, const Vec3& point);

}  // namespace cloth_sim
