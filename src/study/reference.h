#pragma once
/// \file What runs are compared with.

#include <functional>
#include <iosfwd>
#include <optional>
#include <string>

#include "run.h"

namespace cloth_sim {

/// The truth about a scene, as far as it is known.
struct Reference {
  std::string source;     ///< how it was made, one line
  Trajectory trajectory;  ///< empty for a scene about tearing
  TearRecord tearing;     ///< of a scene about tearing
  double ownError = 0.0;  ///< estimate, in the unit of the errors of the study
  double cpuTime = 0.0;   ///< that it took to make [s]; 0: it was read
  bool converged = true;  ///< false: `ownError` is more than was asked for
};

/// The error of a run: of positions over the side of the cloth, or, for a scene about tearing, of
/// the time of separation over what it should be. NaN if there is nothing to compare.
double errorAgainst(const Reference& reference, const StudyScene& study, const RunResult& run);

/// The first method of the registry that says of itself that it is explicit (its substeps are
/// limited, but not to nothing) and of second order.
/// \throws std::runtime_error if there is none.
const SolverInfo& referenceMethod();

/// When to be content.
struct ConvergenceGoal {
  double tolerance = 1e-3;
  int halvings = 4;
  /// No halving is begun that would take more in all [s of CPU time]; one is made in any case.
  double mostCpuTime = std::numeric_limits<double>::infinity();
};

/// A run of `referenceMethod`, whose steps and substeps are halved until two runs differ by no more
/// than `tolerance`, or `halvings` times. (Steps too: contacts are found, clamps moved and phases
/// begun once a step.) \throws std::runtime_error if no run comes through.
Reference convergeReference(const StudyScene& study, const ConvergenceGoal& goal);

// ---- references in files
// -------------------------------------------------------------------------

/// Writes a reference with the figures that tell which scene it belongs to.
void writeReference(std::ostream& out, const StudyScene& study, const Reference& reference);

/// \throws std::runtime_error saying what is wrong: it is unreadable, or the scene has changed.
Reference readReference(const std::string& file, const StudyScene& study);

/// Where the reference of a scene is kept.
std::string referenceFile(const std::string& folder, const std::string& name);

}  // namespace cloth_sim
