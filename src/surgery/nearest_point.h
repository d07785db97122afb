#pragma once
/// \file Points of segments and triangles that are nearest to a given point.

#include <array>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// Returns the point of the segment a-b that is nearest to `p`; a if the segment has no length.
Vec3 nearestPoint(const std::array<Vec3, 2>& segment, const Vec3& p);

/// Returns the point of a triangle that is nearest to `p`. The triangle may be degenerate.
Vec3 nearestPoint(const std::array<Vec3, 3>& triangle, const Vec3& p);

}  // namespace cloth_sim
