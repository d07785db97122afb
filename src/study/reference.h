#pragma once
/// \file References that runs are compared with.

#include <functional>
#include <iosfwd>
#include <optional>
#include <string>

#include "run.h"

namespace cloth_sim {

/// A solution of a scene that is more accurate than the runs that it judges.
struct Reference {
  std::string source;     ///< method and settings, one line
  Trajectory trajectory;  ///< empty for a scene about tearing
  TearRecord tearing;     ///< of a scene about tearing
  double ownError = 0.0;  ///< estimated error, as `errorAgainst` measures it
  double cpuTime = 0.0;   ///< spent on the reference [s]; 0: read from a file
  bool converged = true;  ///< false: `ownError` is above the tolerance asked for
};

/// Returns the error of a run [-]: of positions relative to the side of the cloth or, for a scene
/// about tearing, the relative error of the time of separation. NaN without anything to compare.
double errorAgainst(const Reference& reference, const StudyScene& study, const RunResult& run);

/// Returns the first method of the registry that is explicit (its limit of stability is finite and
/// not zero) and of second order.
/// \throws std::runtime_error if there is none.
const SolverInfo& referenceMethod();

/// When a sequence of refined runs ends.
struct ConvergenceGoal {
  double tolerance = 1e-3;
  int halvings = 4;
  /// Limit of the CPU time of all halvings [s]. No halving that would exceed it is begun, except
  /// the first.
  double mostCpuTime = std::numeric_limits<double>::infinity();
};

/// Runs `referenceMethod` with steps and substeps halved until two runs differ by no more than
/// `tolerance`, at most `halvings` times. (Steps are halved, too, because contacts are found,
/// clamps are moved and phases begin once per step.) \throws std::runtime_error if every run fails.
Reference convergeReference(const StudyScene& study, const ConvergenceGoal& goal);

// ---- references in files ----------------------------------------------------------------------

/// Writes a reference with figures that identify its scene.
void writeReference(std::ostream& out, const StudyScene& study, const Reference& reference);

/// Reads a reference. \throws std::runtime_error if it is unreadable or of a different scene.
Reference readReference(const std::string& file, const StudyScene& study);

/// Returns the path of the reference of a scene.
std::string referenceFile(const std::string& folder, const std::string& name);

}  // namespace cloth_sim
