#pragma once
/// \file The dynamic motion of Blanco-Mulero et al. (2024, Benchmarking the sim-to-real gap in
/// cloth manipulation, IEEE RA-L): two grippers swing a cloth and fling it down.

#include <string>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// Displacement of both grippers at a time since the start [m]: quintic segments of 1.1, 1.5, 1.3
/// and 0.5 s that move by -0.25, 0.30, 0.15, -0.10 m along y and by 0.06, 0.06, -0.51, -0.51 m
/// along z. The velocities along y at their ends are -0.7, 0, -0.3 and 0 m/s. That velocities along
/// z and all accelerations are zero at the ends is chosen here.
Vec3 flingDisplacement(double time);
double flingDuration();  ///< [s]

/// One run: a method at a resolution.
struct FlingSetting {
  std::string method;
  int substeps = 0;    ///< per 1/60 s; 0: chosen by `error`, or by the stable step
  double error = 0.0;  ///< solver.error
  int columns = 21;    ///< of particles over 0.5 m, a multiple of 10, plus 1
};

/// Positions at some times.
struct Fling {
  FlingSetting setting;
  int rows = 0;  ///< of particles over 0.7 m
  std::vector<double> times;
  std::vector<std::vector<Vec3>> positions;  ///< by time, then by particle [m]
};

/// Flings a cloth of 0.5 m x 0.7 m of the preset cotton, which hangs from two corners in still air.
Fling simulateFling(const FlingSetting& setting);

/// Root mean square distance of the particles that two runs have in common [m].
double flingDistance(const Fling& a, const Fling& b);
/// Mean distance of the particles of one run from the nearest particle of another at the same time
/// [m]: the one-sided Chamfer distance.
double flingChamfer(const Fling& from, const Fling& to);

}  // namespace cloth_sim
