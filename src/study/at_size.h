#pragma once
/// \file Errors of positions, strains, forces and energy beside the cost, at the sizes that people
/// run.

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace cloth_sim {

/// One run of a scene, compared with the reference of this scene and size.
struct AtSizeRow {
  std::string scene;       ///< "swing" or "hang"
  int particles = 0;       ///< per side
  std::string method;      ///< of the registry
  int substeps = 0;        ///< per step of 1/60 s; 0: chosen by `error`
  int iterations = 0;      ///< 0: the method has no such parameter
  double error = 0.0;      ///< solver.error; 0: fixed substeps
  double cost = 0.0;       ///< CPU time of the calling thread per step of 1/60 s [s]
  double position = 0.0;   ///< root mean square over times and particles, over the side [-]
  double strain = 0.0;     ///< largest difference of the largest strain at a time [-]
  double strain999 = 0.0;  ///< largest 99.9th percentile of the differences of springs [-]
  double force =
      0.0;  ///< root mean square error of the force at the pins, over that of the force [-]
  double energy = 0.0;  ///< largest error of the mechanical energy, over the energy released [-]
  double estimatedPosition = 0.0;  ///< largest estimate of the method; NaN if it has none [-]
  double estimatedStrain = 0.0;    ///< the same for the largest strain [-]
  std::string status;              ///< "reference", "ok", or why it failed
};

/// The runs of one scene at one size, with their reference first.
struct AtSizeRun {
  std::string scene;
  int particles = 0;
  std::function<std::vector<AtSizeRow>()> make;
};

/// Returns the runs of a cotton of 1 m x 1 m for each number of particles per side:
/// - swing: pinned along an edge, released at 45 degrees, 0.8 s;
/// - hang: pinned at two corners, released horizontally, 1.5 s.
/// The reference is the explicit method of second order with 0.35 of the longest stable substep;
/// its row has the differences of a run with substeps twice as long, which are about four times its
/// own errors while the motion is smooth.
std::vector<AtSizeRun> atSizeRuns(const std::vector<int>& particles);

/// Writes rows as CSV.
void writeAtSize(std::ostream& out, const std::vector<AtSizeRow>& rows);

}  // namespace cloth_sim
