#pragma once
/// \file One scene run with one method, timed and watched.

#include <limits>
#include <string>
#include <vector>

#include "scenes.h"

namespace cloth_sim {

/// What is chosen to advance a scene: a method, its step, and the options that cost.
struct Configuration {
  const SolverInfo* method = nullptr;
  double dt = 0.0;     ///< of a simulation step [s]
  int substeps = 1;    ///< of a step, 1 for a method without them
  int iterations = 0;  ///< 0: the method has no such parameter
};

/// The configuration of a method whose substeps are dt / substeps [s] long: a method that does not
/// divide its steps gets shorter ones.
Configuration configure(const SolverInfo& method, double dt, int substeps, int iterations);

/// The scene with this configuration in place of its own, never asleep.
/// \throws std::invalid_argument if the registry refuses it.
Scene withConfiguration(Scene scene, const Configuration& configuration);

/// Positions at a few times, one row of particles per time.
struct Trajectory {
  std::vector<double> times;                 ///< [s]
  std::vector<std::vector<Vec3>> positions;  ///< [m]
};

enum class Outcome { kOk, kDiverged, kWrong, kRefused, kSkipped };
/// "ok", "diverged", "wrong", "refused" or "skipped".
const char* toString(Outcome outcome);

/// When and how much tore.
struct TearRecord {
  double firstFailure = std::numeric_limits<double>::quiet_NaN();  ///< [s]; NaN: never
  double separation = std::numeric_limits<double>::quiet_NaN();    ///< into two pieces [s]
  int torn = 0;                                                    ///< springs
};

struct RunResult {
  Outcome outcome = Outcome::kOk;
  std::string why;              ///< in words, unless it is ok
  double cpuTime = 0.0;         ///< of the steps, on this thread [s]
  double simulatedTime = 0.0;   ///< [s]
  double largestStretch = 1.0;  ///< length over rest length of a structural or shear spring
  Trajectory trajectory;        ///< up to where it failed
  TearRecord tearing;

  double cpuPerSimulatedSecond() const {
    return simulatedTime > 0.0 ? cpuTime / simulatedTime : 0.0;
  }
};

/// Runs the scene as it is to its duration, or until it fails, or until it is in two pieces if that
/// is what it is about. At one thread only if the caller sets a ThreadLimit.
RunResult runScene(const StudyScene& study);
/// The same with a configuration in place of the scene's own.
RunResult runScene(const StudyScene& study, const Configuration& configuration);

/// Root of the mean square distance over particles and times, over `side`. Infinity if the
/// trajectories do not have the same particles at the same number of times.
double trajectoryError(const Trajectory& trajectory, const Trajectory& reference, double side);

}  // namespace cloth_sim
