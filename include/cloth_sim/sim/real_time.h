#pragma once
/// \file `solver.budget: real_time`: as many substeps as fit into a step on this machine.
///
/// The cost of a step is measured once for each kind of model, kept in a file, and turned into a
/// number of substeps when a scene is loaded. From then on the scene has that number, as if the
/// file said `budget: {real_time: 24}`: no clock runs while it is simulated, and recordings and
/// saved states lead to the same bits on any other machine.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// Time of a step of n substeps on a machine with nothing else to do: perStep + n perSubstep.
struct StepCost {
  double perStep = 0.0;     ///< [s], >= 0
  double perSubstep = 0.0;  ///< [s], > 0
};

/// Returns the part of a step that a calibrated one may take [-]: 0.8 of a cloth alone, and 0.6
/// with obstacles, clamps or tears, which the first steps do not show. The rest is also for
/// publishing.
double realTimeFraction(const Scene& scene);

/// Returns the number of substeps, from 1 to 100,000, with which a step takes at most `time` [s].
int substepsIn(double time, const StepCost& cost);

/// Times steps of the scene from its start, with few substeps and with many in turn, on as many
/// threads as ThreadLimit allows. Other programs should not matter: the quickest of each counts, by
/// the CPU time of the calling thread. Takes about a second.
/// \throws std::runtime_error if the simulation fails meanwhile.
StepCost measureStepCost(Scene scene);

/// All that a calibration depends on: scenes that are equal in this share one.
struct CalibrationKey {
  std::string machine;  ///< host name
  std::string method;
  int threads = 1;
  int particles = 0;
  int springs = 0;
  int plates = 0;     ///< elements of the bending energy
  int obstacles = 0;  ///< in number
  bool wind = false;

  /// The values in the order of the columns of a calibration file.
  std::string text() const;
};

/// \param threads  0: one per processor.
CalibrationKey calibrationKeyOf(const Scene& scene, int threads);

/// The user's file of calibrations. It is complete at all times.
class CalibrationFile {
 public:
  /// \param file  "": nothing is kept.
  explicit CalibrationFile(std::string file) : file_(std::move(file)) {}
  /// The file real_time.csv in $CLOTH_SIM_CACHE, $XDG_CACHE_HOME/cloth_sim or
  /// $HOME/.cache/cloth_sim.
  static CalibrationFile ofUser();

  const std::string& file() const { return file_; }
  /// Returns the cost in the newest row of a key; a missing file has no rows.
  /// \throws std::runtime_error in one line if the file is none of calibrations.
  std::optional<StepCost> find(const CalibrationKey& key) const;
  /// Adds a row, in place of those with the same key. A file that is none of calibrations is
  /// replaced, and so is the oldest of more than a thousand rows.
  /// \throws std::runtime_error in one line if the file cannot be written.
  void add(const CalibrationKey& key, const StepCost& cost) const;

 private:
  std::string file_;
};

/// Loads a scene with further overrides.
using SceneLoader = std::function<Scene(const std::vector<std::string>& overrides)>;
/// Returns a loader of a file. \param overrides  of the file, before the further ones.
SceneLoader loaderOf(const std::string& path, const std::vector<std::string>& overrides);

/// The calibrations of a program.
struct CalibrationSettings {
  CalibrationFile file = CalibrationFile::ofUser();
  int threads = 0;     ///< 0: one per processor
  bool again = false;  ///< measure even if there is a calibration
  /// Called with one line for users: what the budget has become, or what is wrong with the file.
  std::function<void(const std::string& line)> tell;
};

/// Loads a scene for this machine: if its budget is `real_time`, it is replaced by a number of
/// substeps; so is a number that an earlier calibration has led to, if `settings.again`.
/// \throws SceneError as the loader does, std::runtime_error as measureStepCost does.
Scene loadForThisMachine(const SceneLoader& load, const CalibrationSettings& settings);

}  // namespace cloth_sim
