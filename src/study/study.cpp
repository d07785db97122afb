#include "cloth_sim/study/study.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/scene/names.h"
#include "cloth_sim/study/tables.h"

namespace cloth_sim {
namespace {

constexpr ConvergenceGoal kQuickGoal{5e-4, 4};
constexpr ConvergenceGoal kFullGoal{1e-4, 6};

/// Writes a table under another name first: complete or not at all.
template <typename Write>
void writeTable(const std::string& file, const Write& write) {
  const std::string temporary = file + ".tmp";
  std::ofstream out(temporary);
  write(out);
  out.close();
  if (!out || std::rename(temporary.c_str(), file.c_str()) != 0) {
    std::remove(temporary.c_str());
    throw std::runtime_error(file + ": cannot be written");
  }
}

class Study {
 public:
  Study(const StudyOptions& options, StudyProgress& progress)
      : options_(options), progress_(progress) {}

  void run() {
    loadScenes();
    countWork();
    if (options_.workPrecision) compareMethods();
    if (options_.stability) measureLimits();
    if (options_.resolution) compareResolutions();
    progress_.update(total_, total_, "done");
  }

 private:
  void loadScenes() {
    const std::vector<std::string>& known = studySceneNames();
    for (const std::string& name : options_.only) {
      if (std::find(known.begin(), known.end(), name) == known.end()) {
        throw SceneError(name + ": no scene of the study (known: " + joinNames(known) + ")");
      }
    }
    for (const std::string& name : known) {
      const auto& only = options_.only;
      if (!only.empty() && std::find(only.begin(), only.end(), name) == only.end()) continue;
      scenes_.push_back(loadStudyScene(options_.scenes, name));
    }
  }

  Ladder ladder() const { return options_.quick ? quickLadder() : fullLadder(); }

  std::vector<int> resolutions() const {
    if (options_.quick) return {16, 32, 64};
    return {16, 32, 64, 128};
  }

  void countWork() {
    for (const StudyScene& study : scenes_) {
      if (!options_.workPrecision) break;
      ++total_;  // its reference
      for (const SolverInfo& method : solverRegistry()) {
        total_ += static_cast<int>(climb(method, study.scene.solver.dt, ladder()).size());
      }
    }
    if (options_.stability) total_ += 2 * static_cast<int>(solverRegistry().size());
    if (options_.resolution) total_ += 3 * static_cast<int>(resolutions().size());
  }

  void announce(const std::string& next) { progress_.update(done_++, total_, next); }
  Announce announcer() {
    return [this](const std::string& next) { announce(next); };
  }

  std::string file(const std::string& name) const { return options_.out + "/" + name; }

  /// The one in a file, if the scene is smooth and has one that is its own; else a converged run.
  Reference referenceOf(const StudyScene& study) {
    announce(study.name + ", reference");
    if (study.isSmooth()) {
      try {
        return readReference(referenceFile(options_.scenes, study.name), study);
      } catch (const std::runtime_error& error) {
        progress_.remark(std::string(error.what()) + "; a converged run serves instead");
      }
    }
    return convergeReference(study, options_.quick ? kQuickGoal : kFullGoal);
  }

  void compareMethods() {
    std::vector<WorkPrecisionRow> rows;
    std::vector<NamedReference> references;
    for (const StudyScene& study : scenes_) {
      const Reference reference = referenceOf(study);
      references.push_back({study.name, reference.source, reference.ownError});
      for (WorkPrecisionRow& row : measureWorkPrecision(study, reference, ladder(), announcer())) {
        rows.push_back(std::move(row));
      }
    }
    writeTable(file("work_precision.csv"), [&](auto& out) { writeWorkPrecision(out, rows); });
    writeTable(file("tearing.csv"), [&](auto& out) { writeTearing(out, rows); });
    writeTable(file("pareto.csv"), [&](auto& out) { writePareto(out, paretoRows(rows)); });
    writeTable(file("references.csv"), [&](auto& out) { writeReferences(out, references); });
    noteSkipped(rows);
  }

  void noteSkipped(const std::vector<WorkPrecisionRow>& rows) {
    int count = 0;
    writeTable(file("skipped.txt"), [&](auto& out) { count = writeSkipped(out, rows); });
    if (count > 0) {
      progress_.remark(std::to_string(count) + " runs were not made, " + file("skipped.txt") +
                       " says why");
    } else {
      std::remove(file("skipped.txt").c_str());
    }
  }

  void measureLimits() {
    std::vector<StabilityLimit> limits;
    for (const VibratingSystem& system : {makeOscillator(), makeVibratingCloth()}) {
      for (const SolverInfo& method : solverRegistry()) {
        announce("stability, " + system.name + ", " + method.name);
        limits.push_back(measureStability(method, system));
      }
    }
    writeTable(file("stability.csv"), [&](auto& out) { writeStability(out, limits); });
    writeTable(file("stability_limits.csv"), [&](auto& out) { writeStabilityLimits(out, limits); });
  }

  void compareResolutions() {
    const std::vector<ResolutionRow> rows = measureResolution(resolutions(), announcer());
    writeTable(file("resolution.csv"), [&](auto& out) { writeResolution(out, rows); });
  }

  const StudyOptions& options_;
  StudyProgress& progress_;
  std::vector<StudyScene> scenes_;
  int done_ = 0;
  int total_ = 0;
};

}  // namespace

void runStudy(const StudyOptions& options, StudyProgress& progress) {
  Study(options, progress).run();
}

}  // namespace cloth_sim
