#pragma once
/// \file The influence of the resolution and of the direction of the mesh on the motion of a cloth.

#include <functional>
#include <string>
#include <vector>

namespace cloth_sim {

/// One quantity of one fabric at one resolution.
struct ResolutionRow {
  std::string quantity;     ///< "sag", "drape_radius", "swing_period", "hoop_..."
  int particles = 0;        ///< per side
  double value = 0.0;       ///< [m], [s] or [1]; NaN if the run failed
  std::string unit;         ///< "m", "s" or "1"
  double difference = 0.0;  ///< from the finest: relative, or absolute if the unit is 1
  int substeps = 0;         ///< per step of 1/60 s
  double cpuPerSimulatedSecond = 0.0;
};

/// One run, which measures one or more quantities.
struct ResolutionRun {
  std::string name;
  int particles = 0;                                 ///< per side
  std::function<std::vector<ResolutionRow>()> make;  ///< rows without `difference`
};

/// Returns the runs of a square cloth with sides of 0.5 m for each number of particles per side.
/// They use the explicit method of the references with 0.7 of the longest stable substep.
///
/// Quantities of the fabric "interlock":
/// - sag: elongation when it hangs, pinned along its upper edge [m];
/// - drape_radius: mean distance of its border from the axis of the sphere on which it lies [m];
/// - swing_period: period of its centre of mass when it is pinned along its upper edge and released
///   at 20 degrees [s].
/// Quantities of an isotropic fabric that is held outside of a circle, like embroidery in a hoop,
/// from the depths half-way between the centre and the circle:
/// - hoop_sag: mean depth below the hoop [m];
/// - hoop_bias: depth at 45 degrees to the threads less depth along them, over the mean [-];
/// - hoop_skew: depth along the diagonals of the mesh less depth across them, over the mean [-].
/// The exact values of the last two are 0.
std::vector<ResolutionRun> resolutionRuns(const std::vector<int>& particles);

/// Returns the rows sorted by quantity and resolution, with their differences from the finest.
std::vector<ResolutionRow> compareWithFinest(std::vector<ResolutionRow> rows);

}  // namespace cloth_sim
