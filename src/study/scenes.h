#pragma once
/// \file The scenes of the study, with their durations and the times of comparison.

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// A scene of the study. All methods run the same scene but for `scene.solver`.
struct StudyScene {
  std::string name;
  Scene scene;
  double duration = 0.0;  ///< a whole number of the scene's steps [s]
  /// Times at which positions are compared [s]: ascending multiples of the scene's step, the last
  /// of them `duration`.
  std::vector<double> samples;
  /// Compare the time at which the cloth comes apart instead of positions.
  bool tearing = false;
  /// Runs that take more CPU time are stopped [s].
  double mostCpuTime = std::numeric_limits<double>::infinity();

  /// Length to which errors are relative: the longest side of any cloth [m].
  double side() const { return longestSide(scene.cloths); }
  /// Tells whether only springs, dashpots, drag, gravity and fixed pins act: a smooth system of
  /// equations that a general integrator can solve.
  bool isSmooth() const;
};

/// Names the study's own scenes, in the order of the charts.
const std::vector<std::string>& studySceneNames();

/// Loads one of the study's own scenes. Its duration is the sum of the time-outs of its phases.
/// \param folder  the package's config/study.
/// \throws SceneError
StudyScene loadStudyScene(const std::string& folder, const std::string& name);

/// Makes a study of any scene: four times of comparison up to `duration` [s], each a multiple of
/// `multiple` steps of the scene.
StudyScene studyOf(Scene scene, double duration, int multiple = 1);

}  // namespace cloth_sim
