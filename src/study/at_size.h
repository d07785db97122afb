#pragma once
/// \file Errors of positions, strains, forces and energy beside the cost, at the sizes that people
/// run.

#include <functional>
#include <iosfwd>

#include "motion_run.h"

namespace cloth_sim {

/// One run of a scene, compared with the reference of this scene and size.
struct AtSizeRow {
  std::string scene;      ///< name of the motion
  int particles = 0;      ///< per side
  MotionSetting setting;  ///< its method may be another engine
  double cost = 0.0;      ///< CPU time of the calling thread per step of 1/60 s [s]
  MotionErrors errors;
  double estimatedPosition = 0.0;  ///< largest estimate of the method; NaN if it has none [-]
  double estimatedStrain = 0.0;    ///< the same for the largest strain [-]
  std::string status;              ///< "reference", "ok", or why it failed
};

/// The row of a reference: its cost, and the differences of a run with half as many substeps, which
/// are about four times its own errors while the motion is smooth.
AtSizeRow rowOfReference(const Motion& motion, const MotionReference& reference);
/// The row of a run.
AtSizeRow rowOfRun(const Motion& motion, const MotionSetting& setting, const MotionRecord& run,
                   const MotionReference& reference);

/// The runs of one scene at one size, with their reference first.
struct AtSizeRun {
  std::string scene;
  int particles = 0;
  std::function<std::vector<AtSizeRow>()> make;
};

/// Names the motions that are measured at size.
std::vector<std::string> atSizeScenes();

/// Returns the runs of every motion (motion.h) for each number of particles per side. Above 128,
/// only the swing runs, with few settings.
/// \param only  names of motions; empty: all.
std::vector<AtSizeRun> atSizeRuns(const std::vector<int>& particles,
                                  const std::vector<std::string>& only = {});

/// Writes rows as CSV.
void writeAtSize(std::ostream& out, const std::vector<AtSizeRow>& rows);

}  // namespace cloth_sim
