#pragma once
/// \file What is measured of a cloth in a square grid, whoever simulates it.

#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim::bench {

/// Particles of a grid of n x n, row by row; columns of the cloth run across the rows.
using Grid3 = std::vector<Vec3>;

/// How much longer than at rest the worst column of the cloth is, as a part of that.
double columnStretch(const Grid3& x, int n, double side);
/// Length over rest length of the worst edge along a row or a column.
double worstEdge(const Grid3& x, int n, double side);
/// The largest speed [m/s].
double fastest(const Grid3& v);
/// Particles deeper inside a sphere than `depth` [m].
int countInside(const Grid3& x, const Vec3& centre, double radius, double depth);
/// Particles below a height [m].
int countBelow(const Grid3& x, double height);

/// CPU time of this process [s].
double cpuTime();

}  // namespace cloth_sim::bench
