#pragma once
/// \file Chooses method, step and substeps for `solver: {method: auto, error: E}`, from
/// measurements by `cloth_study --make-auto-table` and `cloth_study --advise --cache`. The same
/// table and cache give the same choice on every machine.

#include <iosfwd>
#include <string>
#include <vector>

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// The class of a scene, which decides how errors scale with the step.
enum class SceneClass {
  kSmooth,   ///< springs, air and gravity
  kContact,  ///< obstacles or clamps
  kTearing,  ///< tearing is on, or a phase switches it on
};
/// "smooth", "contact" or "tearing".
const char* toString(SceneClass kind);
SceneClass classOf(const Scene& scene);

/// The time that the substeps of a method scale with.
enum class StepScale {
  kFrequency,  ///< 1 / omega_max, Gershgorin's bound on the cloth's fastest mode: explicit methods
  kCell,       ///< sqrt(side / 9.81 m/s^2) / (particles along a side): methods that propagate
               ///< corrections from spring to spring, or are stable with every step
};
/// "frequency" or "cell".
const char* toString(StepScale scale);
/// Returns kFrequency for a method with a stability limit, else kCell.
StepScale scaleOf(const SolverInfo& info);
/// The value of a scale for a cloth [s].
double stepUnit(StepScale scale, const ClothSpec& cloth);

/// A row of the table: the longest steps with which a method kept an error.
struct AutoRow {
  SceneClass kind = SceneClass::kSmooth;
  double error = 0.0;  ///< bound that all measured scenes of the class kept [-]
  const SolverInfo* method = nullptr;
  double dt = 0.0;       ///< longest step of the simulation [s]
  double substep = 0.0;  ///< longest substep over stepUnit(scaleOf(method)) [-]
  double longest = 0.0;  ///< longest substep [s]: contacts and slow motion do not scale
  double cost = 0.0;     ///< CPU time of one substep of one particle [s]
};
using AutoTable = std::vector<AutoRow>;

/// Writes the table as CSV. \param remark  lines above the table, without "# ".
void writeAutoTable(std::ostream& out, const AutoTable& table, const std::string& remark);
/// Reads a table. \throws std::runtime_error that names the bad line.
AutoTable readAutoTable(std::istream& in);
/// The table of config/auto_methods.csv at the time of the build.
const AutoTable& builtInAutoTable();

/// Returns the cheapest method, step and substeps that keep the error in scenes of this class.
/// Divides the scene's step if the row asks for a shorter one. Other parameters have their
/// defaults. \throws std::invalid_argument, naming the smallest error of the table, if no row is as
/// accurate.
SolverSpec chooseFrom(const AutoTable& table, const Scene& scene, double error);

/// The user's file of measurements of single scenes.
class AutoCache {
 public:
  explicit AutoCache(std::string file) : file_(std::move(file)) {}
  const std::string& file() const { return file_; }

  /// Returns the entry with the largest error that is not above `error`. A missing file has no
  /// entries. \param key  Scene::contentKey.
  /// \throws std::runtime_error if the file is not a cache.
  std::optional<SolverSpec> find(const std::string& key, double error) const;
  /// Adds an entry, or replaces the one with the same key and error. The file is complete at all
  /// times.
  /// \throws std::runtime_error if it cannot be written.
  void add(const std::string& key, double error, const SolverSpec& solver) const;

 private:
  std::string file_;
};

/// Returns the path of auto_methods.csv in the user's cache (support/user_cache.h); "" without one.
std::string autoCacheFile();

/// Replaces `auto` by the choice from the user's cache or else from the built-in table.
/// \throws std::invalid_argument if neither is accurate enough, std::runtime_error if the cache is
///         unreadable.
void resolveAutoMethod(Scene& scene);

}  // namespace cloth_sim
