#pragma once
/// \file `solver: {method: auto, error: E}`: which method, step and substeps a scene gets, from
/// what `cloth_study --make-auto-table` and `cloth_study --advise --cache` have measured. The same
/// table and cache give the same choice on every machine.

#include <iosfwd>
#include <string>
#include <vector>

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// What decides how errors behave.
enum class SceneClass {
  kSmooth,   ///< springs, air and gravity
  kContact,  ///< obstacles or clamps
  kTearing,  ///< tearing is or may be switched on
};
/// "smooth", "contact" or "tearing".
const char* toString(SceneClass kind);
SceneClass classOf(const Scene& scene);

/// What the substeps that a method needs scale with.
enum class StepScale {
  kFrequency,  ///< 1 / omega_max, Gershgorin's bound on the cloth's fastest mode: explicit methods
  kCell,       ///< sqrt(side / 9.81 m/s^2) over the particles along a side: methods that pass
               ///< corrections on from spring to spring, or are stable with any step
};
/// "frequency" or "cell".
const char* toString(StepScale scale);
/// A method that has a limit of stability goes with the frequency, the others with the cell.
StepScale scaleOf(const SolverInfo& info);
/// What a scale means for a cloth [s].
double stepUnit(StepScale scale, const ClothSpec& cloth);

/// One line of the table.
struct AutoRow {
  SceneClass kind = SceneClass::kSmooth;
  double error = 0.0;  ///< kept by all scenes that were measured
  const SolverInfo* method = nullptr;
  double dt = 0.0;       ///< longest step of the simulation [s]
  double substep = 0.0;  ///< longest substep, over stepUnit(scaleOf(method))
  double longest = 0.0;  ///< and never longer than this [s]: contacts and slow motion do not scale
  double cost = 0.0;     ///< CPU time of one substep of one particle [s]
};
using AutoTable = std::vector<AutoRow>;

/// The table as CSV, with `remark` (lines without "# ") above it.
void writeAutoTable(std::ostream& out, const AutoTable& table, const std::string& remark);
/// \throws std::runtime_error naming the line that is wrong.
AutoTable readAutoTable(std::istream& in);
/// config/auto_methods.csv as it was when this was built.
const AutoTable& builtInAutoTable();

/// The cheapest of what the table knows to keep the error in scenes of this class. Steps longer
/// than its rows allow are divided. Options other than the substeps keep their defaults. \throws
/// std::invalid_argument if the table has nothing so accurate, naming the smallest error.
SolverSpec chooseFrom(const AutoTable& table, const Scene& scene, double error);

/// What was measured for single scenes: the user's file.
class AutoCache {
 public:
  explicit AutoCache(std::string file) : file_(std::move(file)) {}
  const std::string& file() const { return file_; }

  /// The entry of the largest error that is not above `error`, if there is one; a file that is not
  /// there has none. \param key  Scene::contentKey.
  /// \throws std::runtime_error if the file is no such cache.
  std::optional<SolverSpec> find(const std::string& key, double error) const;
  /// Adds an entry, in place of one with the same key and error. The file is complete at any time.
  /// \throws std::runtime_error if it cannot be written.
  void add(const std::string& key, double error, const SolverSpec& solver) const;

 private:
  std::string file_;
};

/// $CLOTH_SIM_CACHE/auto_methods.csv, or in $XDG_CACHE_HOME/cloth_sim or $HOME/.cache/cloth_sim; ""
/// if none of them is set.
std::string userCacheFile();

/// Replaces `auto` by what the user's cache or else the built-in table says.
/// \throws std::invalid_argument, std::runtime_error
void resolveAutoMethod(Scene& scene);

}  // namespace cloth_sim
