#pragma once
/// \file Cost against error: every method over a ladder of substeps, on every scene.

#include <functional>
#include <string>
#include <vector>

#include "cloth_sim/study/reference.h"

namespace cloth_sim {

/// How far a ladder goes, and what it may cost.
struct Ladder {
  std::vector<int> stepDivisions;  ///< of the scene's step
  std::vector<int> substeps;       ///< per step of the scene, ascending
  std::vector<double> iterations;  ///< as multiples of a method's default
  int repetitions = 1;             ///< of runs that take less than `repeatBelow`; the best counts
  double repeatBelow = 0.3;        ///< CPU time [s]
  double mostPerRun = 0.0;         ///< runs that are expected to take longer are skipped [s]
  double mostPerMethod = 0.0;      ///< on one scene; what would come after that is skipped [s]
};
Ladder quickLadder();
Ladder fullLadder();

/// All configurations of one method for a scene, by iterations, then steps, then substeps.
std::vector<Configuration> climb(const SolverInfo& method, double dt, const Ladder& ladder);

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

/// Every registered method on one scene. Which rows there are depends on the registry and the
/// ladder only; runs that would take too long are rows that say so.
std::vector<WorkPrecisionRow> measureWorkPrecision(const StudyScene& study,
                                                   const Reference& reference, const Ladder& ladder,
                                                   const Announce& announce);

/// The rows that are on their scene's front of cost and error.
std::vector<WorkPrecisionRow> paretoRows(const std::vector<WorkPrecisionRow>& rows);

}  // namespace cloth_sim
