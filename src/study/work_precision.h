#pragma once
/// \file Cost against error: every method over a ladder of substeps, on every scene.

#include <functional>
#include <string>
#include <vector>

#include "reference.h"

namespace cloth_sim {

/// How far a ladder goes, and what it may cost.
struct Ladder {
  std::vector<int> stepDivisions;  ///< of the scene's step
  std::vector<int> substeps;       ///< per step of the scene, ascending
  /// The same for methods that iterate in each substep: those are dear.
  std::vector<int> substepsWithIterations;
  std::vector<double> iterations;  ///< as multiples of a method's default
  int repetitions = 1;             ///< of runs that take less than `repeatBelow`; the best counts
  double repeatBelow = 0.3;        ///< CPU time [s]
  double mostPerRun = 0.0;         ///< runs that are expected to take longer are skipped [s]
};
Ladder quickLadder();
Ladder fullLadder();

/// Runs of one method on one scene that differ in their substeps only, ascending.
using Climb = std::vector<Configuration>;
/// All that one method climbs in a scene of steps of `dt` [s], by iterations, then steps.
std::vector<Climb> climbs(const SolverInfo& method, double dt, const Ladder& ladder);

/// One line of the result.
struct WorkPrecisionRow {
  std::string scene;
  Configuration configuration;
  RunResult run;
  double error = 0.0;    ///< NaN if there is none
  bool tearing = false;  ///< the scene is about when the cloth separates
};

/// Called before each run with what comes next.
using Announce = std::function<void(const std::string& what)>;

/// Makes the runs of a climb; no row has an error yet. Runs that would take too long, by what the
/// one before took, are rows that say so.
std::vector<WorkPrecisionRow> measureClimb(const StudyScene& study, const Climb& climb,
                                           const Ladder& ladder, const Announce& announce);

/// Fills in the error of a run, and calls it wrong if that is above 1.
void judge(const Reference& reference, const StudyScene& study, WorkPrecisionRow& row);

/// The rows that are on their scene's front of cost and error.
std::vector<WorkPrecisionRow> paretoRows(const std::vector<WorkPrecisionRow>& rows);

}  // namespace cloth_sim
