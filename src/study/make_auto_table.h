#pragma once
/// \file Derives the table of `solver: {method: auto}` from the measurements of the study.

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
  int iterations = 0;    ///< 0: the method has no such option
  double cost = 0.0;     ///< CPU time per simulated second [s/s]
  double error = 0.0;    ///< [-]
  bool ok = false;       ///< the status is "ok"
  bool skipped = false;  ///< the status is "skipped"
};

/// Reads work_precision.csv. \throws std::runtime_error naming the line that is wrong.
std::vector<MeasuredRun> readWorkPrecision(std::istream& in);
/// Reads the references' own errors by scene from references.csv. \throws std::runtime_error
std::map<std::string, double> readOwnErrors(std::istream& in);

/// Makes a row for each class of scenes, each error from 0.1 to 1e-4, each convergent method and
/// each step. The substep of the row is the longest with which the error was kept in all scenes of
/// the class, provided that all shorter measured ones (at least one) kept it, too; a margin is
/// taken off for scenes that were not measured. Errors that the references do not resolve have no
/// rows, nor have errors whose substep is no longer than that of a smaller error.
AutoTable makeAutoTable(const std::vector<StudyScene>& scenes, const std::vector<MeasuredRun>& runs,
                        const std::map<std::string, double>& ownErrors);

}  // namespace cloth_sim
