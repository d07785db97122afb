#pragma once
/// \file Tears by energy beside what is known of them: the force of a trouser tear, and the
/// strength of a strip with a notch.

#include <string>
#include <vector>

namespace cloth_sim {

/// The method of the tests, as YAML: one whose strain at a tip follows from the tension there.
constexpr char kTearSolver[] =
    "method: projective, substeps: 4, iterations: 5, dt: 0.0041666666666666667";

/// A trouser tear (ISO 13937-2): a strip of 0.05 x 0.2 m, cut in from one end, whose two legs are
/// pulled apart. It is cut out of a square cloth of side 0.24 m, at any angle to the threads. The
/// fabric is so stiff that the legs hardly stretch.
struct TrouserTear {
  int particles = 33;   ///< along a side of the square cloth
  double angle = 0.0;   ///< between the strip and the warp [degrees], 0 to 45
  double energy = 2.0;  ///< tear energy of the fabric in all directions [J/m]
  std::string solver = kTearSolver;
};

/// A strip of 0.8 x 1.6 m with a notch in the middle of its long side, pulled along it.
struct NotchedStrip {
  int particles = 65;   ///< across the strip
  double notch = 0.1;   ///< its length [m]
  double energy = 2.0;  ///< tear energy of the fabric in all directions [J/m]
  std::string solver = kTearSolver;
};

/// The force of the clamps over time.
struct ForceTrace {
  std::vector<double> time;   ///< [s]
  std::vector<double> force;  ///< mean of the two clamps over the last step [N]
  std::vector<double> peaks;  ///< largest force before each advance of the tear [N]
};

/// Returns the text of the scene.
std::string sceneOf(const TrouserTear& tear);
std::string sceneOf(const NotchedStrip& strip);

/// Runs a scene to its end or until the cloth is in `pieces`, and records the forces in its phase
/// `pull`.
/// \throws std::runtime_error if the run fails.
ForceTrace traceTear(const std::string& scene, int pieces);

/// The force of a tear: the mean of the peaks, as ISO 13937-2 evaluates it, without the first,
/// which the blunt end of the cut makes.
struct TearForce {
  double mean = 0.0;     ///< [N]
  double scatter = 0.0;  ///< standard deviation of the peaks [N]
  int advances = 0;      ///< number of peaks
};

/// Runs a trouser tear, and returns its force. \throws std::runtime_error if it advances less than
/// twice.
TearForce trouserForce(const TrouserTear& tear);

/// Pulls a strip apart, and returns the largest force that it bears [N].
double strengthOf(const NotchedStrip& strip);

}  // namespace cloth_sim
