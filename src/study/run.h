#pragma once
/// \file A timed run of one scene with one method.

#include <limits>
#include <string>
#include <vector>

#include "scenes.h"

namespace cloth_sim {

/// A method with its step, substeps and iterations.
struct Configuration {
  const SolverInfo* method = nullptr;
  double dt = 0.0;     ///< of a simulation step [s]
  int substeps = 1;    ///< per step; 1 for a method without substeps
  int iterations = 0;  ///< 0: the method has no such parameter
};

/// Returns the configuration of a method with substeps of length h = dt / substeps [s]. A method
/// without substeps gets shorter steps instead.
Configuration configure(const SolverInfo& method, double dt, int substeps, int iterations);

/// Returns the scene with this configuration in place of its own, without sleep.
/// \throws std::invalid_argument if the registry refuses it.
Scene withConfiguration(Scene scene, const Configuration& configuration);

/// Positions at a few times.
struct Trajectory {
  std::vector<double> times;                 ///< [s]
  std::vector<std::vector<Vec3>> positions;  ///< by time, then by particle [m]
};

enum class Outcome { kOk, kDiverged, kWrong, kRefused, kSkipped };
/// Names an outcome: "ok", "diverged", "wrong", "refused" or "skipped".
const char* toString(Outcome outcome);

/// Times and number of tears.
struct TearRecord {
  double firstFailure = std::numeric_limits<double>::quiet_NaN();  ///< [s]; NaN: none
  double separation = std::numeric_limits<double>::quiet_NaN();  ///< into two pieces [s]; NaN: none
  int torn = 0;                                                  ///< springs
};

struct RunResult {
  Outcome outcome = Outcome::kOk;
  std::string why;              ///< reason of the outcome; "" if it is ok
  double cpuTime = 0.0;         ///< of the steps, of the calling thread [s]
  double simulatedTime = 0.0;   ///< [s]
  double largestStretch = 1.0;  ///< length over rest length of a structural or shear spring
  Trajectory trajectory;        ///< up to a failure
  TearRecord tearing;

  double cpuPerSimulatedSecond() const {
    return simulatedTime > 0.0 ? cpuTime / simulatedTime : 0.0;
  }
};

/// Runs the scene with its own configuration to its duration, until it fails, or, for a scene about
/// tearing, until it is in two pieces. Uses one thread only if the caller sets a ThreadLimit.
RunResult runScene(const StudyScene& study);
/// The same with a configuration in place of the scene's own.
RunResult runScene(const StudyScene& study, const Configuration& configuration);

/// Returns the root mean square distance over particles and times, relative to `side` [-]. Infinity
/// if the trajectories differ in the number of times or particles.
double trajectoryError(const Trajectory& trajectory, const Trajectory& reference, double side);

}  // namespace cloth_sim
