#pragma once
/// \file Advice: the cheapest method and model of a scene for a given error.

#include <iosfwd>
#include <optional>

#include "simplify.h"
#include "work_precision.h"

namespace cloth_sim {

struct AdviceRequest {
  SceneLoader load;       ///< loads the scene
  double bound = 0.01;    ///< largest error allowed [-]
  double duration = 1.0;  ///< simulated time of each run [s]
  double budget = 120.0;  ///< CPU time after which no run is begun [s]
  /// Simplify the scene, too; false: only choose its `solver`.
  bool simplify = true;
};

/// A change of the scene that was tried on top of the best configuration so far.
struct TriedChange {
  Simplification change;
  RunResult run;
  double error = 0.0;   ///< NaN: not known
  double before = 0.0;  ///< cost without the change [s/s]
  bool made = false;    ///< the change was kept

  /// Fraction of the cost that the change saves [-].
  double saved() const { return 1.0 - run.cpuPerSimulatedSecond() / before; }
};

struct Advice {
  StudyScene study;                      ///< the unchanged scene
  double bound = 0.0;                    ///< largest error allowed [-]
  Reference reference;                   ///< of the unchanged scene
  RunResult own;                         ///< with the scene's own configuration
  double ownError = 0.0;                 ///< error of `own`; NaN: not known
  std::vector<WorkPrecisionRow> tried;   ///< runs of the unchanged scene
  std::optional<WorkPrecisionRow> best;  ///< the cheapest that keeps the bound
  std::vector<TriedChange> changes;      ///< in the order of the trials
  std::vector<std::string> overrides;    ///< of the scene for `best`, but for `solver`
  double cpuTime = 0.0;                  ///< of all runs [s]
  bool complete = true;                  ///< false: the budget ran out
};

/// Searches greedily for the cheapest configuration that keeps the error.
///  1. Method, step and substeps: every registered method runs with its default options and 1, 2,
///     4 ... substeps of the scene's step, until its error is within the bound twice in a row (once
///     may be an accident), or it costs more than the cheapest method that achieved this. The best
///     method then runs with twice and with half the step. If none keeps the bound, all methods run
///     with a quarter of the step.
///  2. Each simplification of the scene in turn: it is kept if the error stays within the bound and
///     the cost falls.
///  3. Fewer substeps, if the scene was simplified.
///
/// Errors are relative to a converged run of the unchanged scene (see `convergeReference`): of the
/// time of separation if the cloth comes apart within the duration, else of positions at the
/// material points of the particles.
/// \throws SceneError, std::runtime_error if no converged run succeeds.
Advice advise(const AdviceRequest& request, const Announce& announce);

/// Writes an advice for a user: all trials, and the cheapest configuration as a block of YAML for
/// the scene and as overrides for cloth_run.
/// \param scene  the argument SCENE of cloth_run.
void writeAdvice(std::ostream& out, const Advice& advice, const std::string& scene);

}  // namespace cloth_sim
