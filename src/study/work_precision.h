#pragma once
/// \file Cost against error of every method over a ladder of substeps, for a scene.

#include <functional>
#include <string>
#include <vector>

#include "reference.h"

namespace cloth_sim {

/// The configurations that are measured, and the cost of a run.
struct Ladder {
  std::vector<int> stepDivisions;  ///< of the scene's step
  std::vector<int> substeps;       ///< per step of the scene, ascending
  /// The same for methods that iterate in each substep: these are expensive.
  std::vector<int> substepsWithIterations;
  std::vector<double> iterations;  ///< as multiples of a method's default
  int repetitions = 1;             ///< of runs that take less than `repeatBelow`; the best counts
  double repeatBelow = 0.3;        ///< CPU time [s]
  double mostPerRun = 0.0;         ///< runs expected to take more CPU time are skipped [s]
};
Ladder quickLadder();
Ladder fullLadder();

/// Configurations of one method that differ in their substeps only, ascending.
using Climb = std::vector<Configuration>;
/// Returns all climbs of a method in a scene with steps of `dt` [s], by iterations, then steps.
std::vector<Climb> climbs(const SolverInfo& method, double dt, const Ladder& ladder);

/// One run with its error.
struct WorkPrecisionRow {
  std::string scene;
  Configuration configuration;
  RunResult run;
  double error = 0.0;    ///< [-]; NaN: not known
  bool tearing = false;  ///< the error is of the time of separation
};

/// Called before each run with a description of it.
using Announce = std::function<void(const std::string& what)>;

/// Makes the runs of a climb; the rows have no errors yet. A run that would take too long, judged
/// by the one before, is skipped, and its row says so.
std::vector<WorkPrecisionRow> measureClimb(const StudyScene& study, const Climb& climb,
                                           const Ladder& ladder, const Announce& announce);

/// Sets the error of a run, and its outcome to kWrong if the error is above 1.
void judge(const Reference& reference, const StudyScene& study, WorkPrecisionRow& row);

/// Returns the rows on the Pareto front of their scene.
std::vector<WorkPrecisionRow> paretoRows(const std::vector<WorkPrecisionRow>& rows);

}  // namespace cloth_sim
