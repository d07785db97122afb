#pragma once
/// \file The whole study: runs it and writes its tables.

#include <string>
#include <vector>

#include "work_precision.h"

namespace cloth_sim {

struct StudyOptions {
  bool quick = false;
  std::string scenes;             ///< folder of the study's scenes and their references
  std::string out;                ///< folder that the tables go to; it exists
  std::vector<std::string> only;  ///< names of scenes; none: all
  bool workPrecision = true;      ///< parts of the study
  bool stability = true;
  bool resolution = true;
  int jobs = 1;  ///< threads; each run is in, and timed in, one of them
};

/// Tells how far it is. `done` of `total` pieces of work lie behind it.
class StudyProgress {
 public:
  virtual ~StudyProgress() = default;
  virtual void update(int done, int total, const std::string& next) = 0;
  /// Something that the reader of the tables should know, one line.
  virtual void remark(const std::string& text) = 0;
};

/// \throws SceneError, std::runtime_error if an input is missing or a table cannot be written.
void runStudy(const StudyOptions& options, StudyProgress& progress);

}  // namespace cloth_sim
