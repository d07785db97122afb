#pragma once
/// \file How much of what a cloth does depends on how finely it is divided.

#include <string>
#include <vector>

#include "cloth_sim/study/work_precision.h"

namespace cloth_sim {

/// One quantity of one fabric at one resolution.
struct ResolutionRow {
  std::string quantity;     ///< "sag", "drape_radius", "swing_period"
  int particles = 0;        ///< a side
  double value = 0.0;       ///< [m] or [s]; NaN if the run failed
  std::string unit;         ///< "m" or "s"
  double difference = 0.0;  ///< from the finest, relative
  int substeps = 0;         ///< of a step of 1/60 s
  double cpuPerSimulatedSecond = 0.0;
};

/// The same cloth of 0.5 m (fabric "interlock") with each number of particles a side, advanced by
/// the explicit method that references are made with, at 0.7 of the longest stable step:
/// - sag: how much longer it hangs, pinned along its upper edge, than it is at rest [m];
/// - drape_radius: mean distance of its border from the axis of the sphere that it lies on [m];
/// - swing_period: of its centre of mass, pinned along its upper edge, let go at 20 degrees [s].
std::vector<ResolutionRow> measureResolution(const std::vector<int>& particles,
                                             const Announce& announce);

}  // namespace cloth_sim
