#pragma once
/// \file The table of `solver: {method: auto}` from what the study has measured.

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "scene/auto_method.h"
#include "scenes.h"

namespace cloth_sim {

/// A row of work_precision.csv.
struct MeasuredRun {
  std::string scene;
  std::string method;
  double dt = 0.0;  ///< [s]
  int substeps = 0;
  int iterations = 0;  ///< 0: the method has no such option
  double cost = 0.0;   ///< CPU time per simulated second [s/s]
  double error = 0.0;
  bool ok = false;       ///< status
  bool skipped = false;  ///< status
};

/// \throws std::runtime_error if it is no such table.
std::vector<MeasuredRun> readWorkPrecision(std::istream& in);
/// The references' own errors by scene, from references.csv. \throws std::runtime_error
std::map<std::string, double> readOwnErrors(std::istream& in);

/// For each class of scenes, each error from 0.1 to 1e-4, each method that converges and each step:
/// the longest substep with which, and with all shorter ones that were measured (one at least), the
/// error was kept in all scenes of the class; a part off for scenes that were not measured. Errors
/// that the references do not resolve are left out, and rows that a smaller error's make
/// superfluous.
AutoTable makeAutoTable(const std::vector<StudyScene>& scenes, const std::vector<MeasuredRun>& runs,
                        const std::map<std::string, double>& ownErrors);

}  // namespace cloth_sim
