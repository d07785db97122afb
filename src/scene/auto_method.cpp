#include "auto_method.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/scene/build.h"
#include "scene_node.h"
#include "support/user_cache.h"

namespace cloth_sim {
namespace {

constexpr double kGravity = 9.81;   ///< of StepScale::kCell [m/s^2]
constexpr int kPatch = 8;           ///< particles a side of a patch with the highest frequency
constexpr double kRounding = 1e-9;  ///< relative round-off of a quotient that should be whole
constexpr double kMostSubsteps = 1e5;

bool maySwitchTearingOn(const PhaseSpec& phase) { return phase.tearing.value_or(false); }

/// Rounds up to a whole number of at least 1.
double roundUp(double quotient) { return std::max(1.0, std::ceil(quotient * (1.0 - kRounding))); }

/// A row applied to a scene.
struct Candidate {
  const AutoRow* row = nullptr;
  double dt = 0.0;        ///< [s]
  double substeps = 0.0;  ///< per dt
  double cost =
      std::numeric_limits<double>::infinity();  ///< CPU time per particle and simulated time [s/s]
};

Candidate apply(const AutoRow& row, const Scene& scene) {
  Candidate candidate;
  candidate.row = &row;
  candidate.dt = scene.solver.dt / roundUp(scene.solver.dt / row.dt);
  double longest = row.longest;
  for (const ClothSpec& cloth : scene.cloths) {
    longest = std::min(longest, row.substep * stepUnit(scaleOf(*row.method), cloth));
  }
  candidate.substeps = roundUp(candidate.dt / longest);
  if (candidate.substeps <= kMostSubsteps) {
    candidate.cost = row.cost * candidate.substeps / candidate.dt;
  }
  return candidate;
}

[[noreturn]] void refuseError(const AutoTable& table, SceneClass kind, double error) {
  double least = std::numeric_limits<double>::infinity();
  for (const AutoRow& row : table) {
    if (row.kind == kind) least = std::min(least, row.error);
  }
  throw std::invalid_argument("error: expected at least " + shortNumber(least) +
                              ", the smallest that was measured for scenes of the class '" +
                              toString(kind) + "' (got " + shortNumber(error) +
                              "; see cloth_study --advise)");
}

}  // namespace

const char* toString(SceneClass kind) {
  switch (kind) {
    case SceneClass::kSmooth:
      return "smooth";
    case SceneClass::kContact:
      return "contact";
    case SceneClass::kTearing:
      return "tearing";
  }
  return "?";
}

const char* toString(StepScale scale) {
  return scale == StepScale::kFrequency ? "frequency" : "cell";
}

SceneClass classOf(const Scene& scene) {
  if (scene.tearing.enabled ||
      std::any_of(scene.phases.begin(), scene.phases.end(), maySwitchTearingOn)) {
    return SceneClass::kTearing;
  }
  const bool touches = !scene.obstacles.empty() || !scene.clamps.empty();
  return touches ? SceneClass::kContact : SceneClass::kSmooth;
}

StepScale scaleOf(const SolverInfo& info) {
  return std::isfinite(info.stabilityLimit) ? StepScale::kFrequency : StepScale::kCell;
}

double stepUnit(StepScale scale, const ClothSpec& cloth) {
  if (scale == StepScale::kCell) {
    return std::sqrt(std::max(cloth.width, cloth.height) / kGravity) /
           std::max(cloth.columns, cloth.rows);
  }
  // The fastest mode of a uniform cloth is local, so a small patch of it has the same one.
  ClothSpec patch = cloth;
  patch.columns = std::min(cloth.columns, kPatch);
  patch.rows = std::min(cloth.rows, kPatch);
  patch.width *= (patch.columns - 1.0) / (cloth.columns - 1.0);
  patch.height *= (patch.rows - 1.0) / (cloth.rows - 1.0);
  patch.pins.clear();
  return 0.5 * stableStep(buildModel(patch));  // 2 / omega_max without damping
}

SolverSpec chooseFrom(const AutoTable& table, const Scene& scene, double error) {
  const SceneClass kind = classOf(scene);
  Candidate best;
  for (const AutoRow& row : table) {
    if (row.kind != kind || row.error > error * (1.0 + kRounding)) continue;
    const Candidate candidate = apply(row, scene);
    if (candidate.cost < best.cost) best = candidate;
  }
  if (best.row == nullptr) refuseError(table, kind, error);
  SolverSpec solver = scene.solver;
  solver.method = best.row->method->name;
  solver.dt = best.dt;
  solver.parameters = completeParameters(*best.row->method, {{"substeps", best.substeps}});
  return solver;
}

std::string autoCacheFile() { return userCacheFile("auto_methods.csv"); }

void resolveAutoMethod(Scene& scene) {
  const double error = scene.solver.choice->error;
  const AutoCache cache(autoCacheFile());
  std::optional<SolverSpec> solver;
  AutoChoice choice{error, "measured on this scene, " + cache.file()};
  if (!cache.file().empty()) solver = cache.find(scene.contentKey, error);
  if (!solver) {
    solver = chooseFrom(builtInAutoTable(), scene, error);
    choice.source = std::string("measured on scenes of the class ") + toString(classOf(scene));
  }
  solver->guard = scene.solver.guard;
  solver->sleep = scene.solver.sleep;
  solver->choice = choice;
  scene.solver = std::move(*solver);
}

}  // namespace cloth_sim
