#pragma once
/// \file The width of a draped cloth.

#include <vector>

#include "cloth_sim/mesh/grid.h"

namespace cloth_sim {

/// Returns the mean distance of the particles of the border from the z axis [m].
/// \param positions  of a grid, by vertex [m].
double borderRadius(const Grid& grid, const std::vector<Vec3>& positions);

}  // namespace cloth_sim
