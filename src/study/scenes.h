#pragma once
/// \file What is compared: scenes, for how long, and when one looks at them.

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// A scene of the study. The methods differ in `scene.solver`; all else is the same for them.
struct StudyScene {
  std::string name;
  Scene scene;
  double duration = 0.0;  ///< [s], a whole number of the scene's steps
  /// When positions are compared [s], ascending, multiples of the scene's step. The last is
  /// `duration`.
  std::vector<double> samples;
  /// It is about when the cloth falls apart, not about where it is.
  bool tearing = false;
  /// Runs that take longer are broken off [s of CPU time].
  double mostCpuTime = std::numeric_limits<double>::infinity();

  /// Side that errors are relative to: the longest one of any cloth [m].
  double side() const { return longestSide(scene.cloths); }
  /// Whether springs, dashpots, drag and gravity are all that acts, on pins that rest: a system of
  /// smooth equations that a general integrator can solve.
  bool isSmooth() const;
};

/// The names of the study's own scenes, in the order of the charts.
const std::vector<std::string>& studySceneNames();

/// One of the study's own scenes. It lasts as long as the time-outs of its phases.
/// \param folder  the package's config/study.
/// \throws SceneError
StudyScene loadStudyScene(const std::string& folder, const std::string& name);

/// Any scene, compared at four times up to `duration` [s]; these are whole numbers of `multiple`
/// steps of the scene.
StudyScene studyOf(Scene scene, double duration, int multiple = 1);

}  // namespace cloth_sim
