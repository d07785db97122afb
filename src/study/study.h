#pragma once
/// \file Runs the whole study and writes its tables.

#include <string>
#include <vector>

#include "work_precision.h"

namespace cloth_sim {

struct StudyOptions {
  bool quick = false;
  std::string scenes;             ///< folder of the study's scenes and their references
  std::string out;                ///< existing folder for the tables
  std::vector<std::string> only;  ///< names of scenes; empty: all
  /// Particles per side in the part `atSize`; empty: 16 to 256, 16 and 32 with `quick`.
  std::vector<int> sizes;
  // Parts of the study.
  bool workPrecision = true;
  bool stability = true;
  bool resolution = true;
  bool atSize = false;   ///< takes most of an hour, a minute with `quick`
  bool reality = false;  ///< takes a quarter of an hour, a minute with `quick`
  int jobs = 1;          ///< threads; each run is made and timed in one of them
};

/// Receives the progress of a study.
class StudyProgress {
 public:
  virtual ~StudyProgress() = default;
  /// `done` of `total` pieces of work are finished; `next` describes the next one.
  virtual void update(int done, int total, const std::string& next) = 0;
  /// Passes on a line that the reader of the tables should know.
  virtual void remark(const std::string& text) = 0;
};

/// Returns the files that a study with these options writes.
std::vector<std::string> tablesOf(const StudyOptions& options);

/// Runs the study. \throws SceneError, std::runtime_error if an input is missing or a table cannot
/// be written.
void runStudy(const StudyOptions& options, StudyProgress& progress);

}  // namespace cloth_sim
