#pragma once
/// \file How much of what a cloth does depends on how finely, and which way, it is divided.

#include <functional>
#include <string>
#include <vector>

namespace cloth_sim {

/// One quantity of one fabric at one resolution.
struct ResolutionRow {
  std::string quantity;     ///< "sag", "drape_radius", "swing_period", "hoop_..."
  int particles = 0;        ///< a side
  double value = 0.0;       ///< [m], [s] or [1]; NaN if the run failed
  std::string unit;         ///< "m", "s" or "1"
  double difference = 0.0;  ///< from the finest: relative, absolute where the unit is 1
  int substeps = 0;         ///< of a step of 1/60 s
  double cpuPerSimulatedSecond = 0.0;
};

/// One run that says something about one or more quantities.
struct ResolutionRun {
  std::string name;
  int particles = 0;                                 ///< a side
  std::function<std::vector<ResolutionRow>()> make;  ///< rows without their difference
};

/// A cloth of 0.5 m with each number of particles a side, advanced by the explicit method that
/// references are made with, at 0.7 of the longest stable step; of the fabric "interlock":
/// - sag: how much longer it hangs, pinned along its upper edge, than it is at rest [m];
/// - drape_radius: mean distance of its border from the axis of the sphere that it lies on [m];
/// - swing_period: of its centre of mass, pinned along its upper edge, let go at 20 degrees [s];
/// of a fabric that is as stiff in all directions, held outside of a circle like embroidery in a
/// hoop, at the points half-way between the middle and the circle:
/// - hoop_sag: mean depth below the hoop [m];
/// - hoop_bias: how much deeper it is at 45 degrees to the threads than along them, over the mean;
/// - hoop_skew: how much deeper it is along the diagonals of the mesh than across, over the mean.
/// The last two are 0 without a mesh.
std::vector<ResolutionRun> resolutionRuns(const std::vector<int>& particles);

/// Rows sorted by quantity and resolution, with their differences from the finest.
std::vector<ResolutionRow> compareWithFinest(std::vector<ResolutionRow> rows);

}  // namespace cloth_sim
