#pragma once
/// \file Figures of a cloth in a square grid.

#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim::bench {

/// Values of n x n particles, row by row; columns of the cloth run across the rows.
using Grid3 = std::vector<Vec3>;

/// Strain of the longest column of the cloth [-].
double columnStretch(const Grid3& x, int n, double side);
/// Largest ratio of length to rest length of an edge along a row or a column [-].
double worstEdge(const Grid3& x, int n, double side);
/// Largest speed [m/s].
double fastest(const Grid3& v);
/// Number of particles that are deeper than `depth` inside a sphere; lengths in [m].
int countInside(const Grid3& x, const Vec3& centre, double radius, double depth);
/// Number of particles below `height` [m].
int countBelow(const Grid3& x, double height);

/// CPU time of this process [s].
double cpuTime();

}  // namespace cloth_sim::bench
