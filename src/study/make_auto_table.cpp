#include "make_auto_table.h"

#include <algorithm>
#include <cmath>
#include <istream>
#include <optional>
#include <set>

#include "run.h"
#include "support/csv.h"

namespace cloth_sim {
namespace {

const double kErrors[] = {1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1};  // ascending
/// Substeps of the table over the longest that kept the error: a margin for other scenes than those
/// that were measured.
constexpr double kMargin = 0.7;
/// A reference resolves errors down to this many times its own.
constexpr double kResolved = 3.0;

/// The longest substep of a method that keeps an error.
struct Need {
  double substep = 0.0;  ///< over stepUnit
  double longest = 0.0;  ///< [s]
  double cost = 0.0;     ///< of a substep of a particle [s]
};

/// The runs of one method and step in one scene, by ascending substeps.
using Rungs = std::vector<MeasuredRun>;

std::optional<MeasuredRun> firstThatKeeps(double error, const Rungs& rungs) {
  std::optional<MeasuredRun> first;
  int kept = 0;
  for (auto rung = rungs.rbegin(); rung != rungs.rend(); ++rung) {
    if (!rung->ok || rung->error > error) break;
    first = *rung;
    ++kept;
  }
  return kept > 1 ? first : std::nullopt;
}

class TableMaker {
 public:
  TableMaker(const std::vector<StudyScene>& scenes, const std::vector<MeasuredRun>& runs,
             const std::map<std::string, double>& ownErrors)
      : scenes_(scenes), runs_(runs), ownErrors_(ownErrors) {
    for (const MeasuredRun& run : runs) steps_.insert(run.dt);
  }

  AutoTable make() const {
    AutoTable table;
    for (const SceneClass kind :
         {SceneClass::kSmooth, SceneClass::kContact, SceneClass::kTearing}) {
      for (const SolverInfo& method : solverRegistry()) {
        // Methods that do not converge, or are stable only with damping, are left out.
        if (method.order == 0 || method.stabilityLimit == 0.0) continue;
        for (const double dt : steps_) addRows(kind, method, dt, table);
      }
    }
    return table;
  }

 private:
  void addRows(SceneClass kind, const SolverInfo& method, double dt, AutoTable& table) const {
    double longest = 0.0;
    for (const double error : kErrors) {
      const std::optional<Need> need = needOf(kind, method, dt, error);
      if (!need || need->substep <= longest) continue;
      longest = need->substep;
      table.push_back({kind, error, &method, dt, need->substep, need->longest, need->cost});
    }
  }

  /// The need in all scenes of a class.
  std::optional<Need> needOf(SceneClass kind, const SolverInfo& method, double dt,
                             double error) const {
    std::optional<Need> most;
    for (const StudyScene& study : scenes_) {
      if (classOf(study.scene) != kind) continue;
      const std::optional<Need> need = needOf(study, method, dt, error);
      if (!need) return std::nullopt;
      if (!most) {
        most = need;
      } else {
        most->substep = std::min(most->substep, need->substep);
        most->longest = std::min(most->longest, need->longest);
        most->cost = std::max(most->cost, need->cost);
      }
    }
    return most;
  }

  std::optional<Need> needOf(const StudyScene& study, const SolverInfo& method, double dt,
                             double error) const {
    const auto own = ownErrors_.find(study.name);
    if (own == ownErrors_.end() || error < kResolved * own->second) return std::nullopt;
    const auto run = firstThatKeeps(error, rungsOf(study, method, dt));
    if (!run) return std::nullopt;
    const double substep = dt / run->substeps;
    const ClothSpec& cloth = study.scene.cloths[0];
    return Need{kMargin * substep / stepUnit(scaleOf(method), cloth), kMargin * substep,
                run->cost * substep / (static_cast<double>(cloth.columns) * cloth.rows)};
  }

  Rungs rungsOf(const StudyScene& study, const SolverInfo& method, double dt) const {
    const SolverParameter* iterations = findParameter(method, "iterations");
    const double usual = iterations != nullptr ? iterations->defaultValue : 0.0;
    Rungs rungs;
    for (const MeasuredRun& run : runs_) {
      if (run.scene == study.name && run.method == method.name && run.dt == dt &&
          run.iterations == usual && !run.skipped) {
        rungs.push_back(run);
      }
    }
    std::sort(rungs.begin(), rungs.end(),
              [](const MeasuredRun& a, const MeasuredRun& b) { return a.substeps < b.substeps; });
    return rungs;
  }

  const std::vector<StudyScene>& scenes_;
  const std::vector<MeasuredRun>& runs_;
  const std::map<std::string, double>& ownErrors_;
  std::set<double> steps_;  ///< [s]
};

}  // namespace

std::vector<MeasuredRun> readWorkPrecision(std::istream& in) {
  std::vector<MeasuredRun> runs;
  readCsv(in,
          {"scene", "solver", "dt", "substeps", "iterations", "cpu_s_per_sim_s", "error", "status"},
          [&](const CsvRow& row) {
            MeasuredRun run;
            run.scene = row.text("scene");
            run.method = row.text("solver");
            run.dt = row.number("dt");
            run.substeps = static_cast<int>(row.number("substeps"));
            run.iterations = static_cast<int>(row.number("iterations"));
            run.cost = row.number("cpu_s_per_sim_s");
            run.error = row.number("error");
            run.ok = row.text("status") == toString(Outcome::kOk);
            run.skipped = row.text("status") == toString(Outcome::kSkipped);
            runs.push_back(std::move(run));
          });
  return runs;
}

std::map<std::string, double> readOwnErrors(std::istream& in) {
  std::map<std::string, double> errors;
  readCsv(in, {"scene", "own_error"},
          [&](const CsvRow& row) { errors[row.text("scene")] = row.number("own_error"); });
  return errors;
}

AutoTable makeAutoTable(const std::vector<StudyScene>& scenes, const std::vector<MeasuredRun>& runs,
                        const std::map<std::string, double>& ownErrors) {
  return TableMaker(scenes, runs, ownErrors).make();
}

}  // namespace cloth_sim
