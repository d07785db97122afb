#pragma once
/// \file The cheapest model of a scene for an error that one can live with.

#include <iosfwd>
#include <optional>

#include "simplify.h"
#include "work_precision.h"

namespace cloth_sim {

struct AdviceRequest {
  SceneLoader load;       ///< the scene that advice is asked for
  double bound = 0.01;    ///< on the error
  double duration = 1.0;  ///< how much of the scene is looked at [s]
  double budget = 120.0;  ///< CPU time after which nothing new is tried [s]
  /// Whether the scene may be simplified, or only its `solver` chosen.
  bool simplify = true;
};

/// A change that was tried, with everything else as the best so far.
struct TriedChange {
  Simplification change;
  RunResult run;
  double error = 0.0;   ///< NaN if there is none
  double before = 0.0;  ///< cost without the change [s/s]
  bool made = false;

  double saved() const { return 1.0 - run.cpuPerSimulatedSecond() / before; }  ///< part of the cost
};

struct Advice {
  StudyScene study;                      ///< the scene as it is
  double bound = 0.0;                    ///< on the error
  Reference reference;                   ///< of the scene as it is
  RunResult own;                         ///< with the scene's own configuration
  double ownError = 0.0;                 ///< of that; NaN if there is none
  std::vector<WorkPrecisionRow> tried;   ///< on the scene as it is
  std::optional<WorkPrecisionRow> best;  ///< the cheapest that keeps the bound
  std::vector<TriedChange> changes;      ///< in the order of trying
  std::vector<std::string> overrides;    ///< of the scene for `best`, without those of `solver`
  double cpuTime = 0.0;                  ///< of all runs [s]
  bool complete = true;                  ///< false: the budget ran out
};

/// Searches greedily, not all combinations. First a method, its step and substeps: every registered
/// method with its default options and 1, 2, 4 ... substeps of the scene's step, until its error is
/// within the bound and stays there with twice the substeps (once may be an accident), or it costs
/// more than the cheapest that does so; then the best one with twice and half the step. (If none
/// keeps the bound, all with a quarter of the step.) Then each simplification of the scene in turn:
/// it is made if the error stays within the bound and the cost falls. Last, fewer substeps, where
/// the scene has become coarser.
///
/// Errors are against a converged run of the scene as it is (see `convergeReference`): of the time
/// of separation if it comes apart within the duration, else of positions, at the material points
/// of its particles. \throws SceneError, std::runtime_error if no converged run comes through.
Advice advise(const AdviceRequest& request, const Announce& announce);

/// For people, with the winner as a block of YAML for the scene and as overrides for cloth_run.
/// \param scene  as cloth_run is told of it.
void writeAdvice(std::ostream& out, const Advice& advice, const std::string& scene);

}  // namespace cloth_sim
