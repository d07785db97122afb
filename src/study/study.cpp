#include "study.h"

#include <algorithm>
#include <mutex>
#include <sstream>
#include <stdexcept>

#include "at_size.h"
#include "cloth_sim/scene/load.h"
#include "jobs.h"
#include "reality.h"
#include "resolution.h"
#include "scene/names.h"
#include "stability.h"
#include "support/output_file.h"
#include "tables.h"

namespace cloth_sim {
namespace {

constexpr ConvergenceGoal kQuickGoal{5e-4, 4};
constexpr ConvergenceGoal kFullGoal{1e-4, 6};

/// Writes a table completely or not at all.
template <typename Write>
void writeTable(const std::string& file, const Write& write) {
  std::ostringstream out;
  write(out);
  OutputFile(file, {Links::kFollowed, true}).write(out.str());
}

/// Plans the study as independent jobs, runs them, and writes the tables when all are done.
class Study {
 public:
  Study(const StudyOptions& options, StudyProgress& progress)
      : options_(options),
        progress_(progress),
        ladder_(options.quick ? quickLadder() : fullLadder()) {}

  void run() {
    checkNames();
    // The longest first, so that no thread waits long for the last.
    if (options_.reality) planReality();
    if (options_.atSize) planSizes();
    if (options_.resolution) planResolutions();
    if (options_.workPrecision) planComparisons();
    if (options_.stability) planLimits();
    runJobs(jobs_, options_.jobs);
    if (options_.reality) writeReality();
    if (options_.atSize) writeSizes();
    if (options_.resolution) writeResolutions();
    if (options_.workPrecision) writeComparisons();
    if (options_.stability) writeLimits();
    progress_.update(total_, total_, "done");
  }

 private:
  /// A scene with its reference and its runs.
  struct Compared {
    StudyScene study;
    Reference reference;
    std::vector<std::vector<WorkPrecisionRow>> climbs;
  };

  void add(int pieces, std::function<void()> job) {
    total_ += pieces;
    jobs_.push_back(std::move(job));
  }

  void announce(const std::string& next) {
    const std::lock_guard<std::mutex> lock(mutex_);
    progress_.update(done_++, total_, next);
  }

  void remark(const std::string& text) {
    const std::lock_guard<std::mutex> lock(mutex_);
    progress_.remark(text);
  }

  /// Refuses names that no part of this study knows.
  void checkNames() const {
    std::vector<std::string> known = studySceneNames();
    if (options_.atSize) {
      if (!options_.workPrecision) known.clear();
      for (const std::string& name : atSizeScenes()) known.push_back(name);
    }
    for (const std::string& name : options_.only) {
      if (std::find(known.begin(), known.end(), name) == known.end()) {
        throw SceneError(name + ": no scene of the study (known: " + joinNames(known) + ")");
      }
    }
  }

  bool isAsked(const std::string& name) const {
    const std::vector<std::string>& only = options_.only;
    return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
  }

  std::string file(const std::string& name) const { return options_.out + "/" + name; }

  // ---- cost against error

  void planComparisons() {
    for (const std::string& name : sceneNames()) {
      scenes_.push_back({loadStudyScene(options_.scenes, name), {}, {}});
    }
    for (Compared& scene : scenes_) {
      add(1, [this, &scene] { scene.reference = referenceOf(scene.study); });
      planClimbs(scene);
    }
  }

  void planClimbs(Compared& scene) {
    std::vector<Climb> all;
    for (const SolverInfo& method : solverRegistry()) {
      for (Climb& climb : climbs(method, scene.study.scene.solver.dt, ladder_)) {
        all.push_back(std::move(climb));
      }
    }
    scene.climbs.resize(all.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
      const int pieces = static_cast<int>(all[k].size());
      add(pieces, [this, &scene, k, climb = std::move(all[k])] {
        scene.climbs[k] = measureClimb(scene.study, climb, ladder_,
                                       [this](const std::string& next) { announce(next); });
      });
    }
  }

  std::vector<std::string> sceneNames() const {
    std::vector<std::string> names = studySceneNames();
    const auto isLeftOut = [this](const std::string& name) { return !isAsked(name); };
    names.erase(std::remove_if(names.begin(), names.end(), isLeftOut), names.end());
    return names;
  }

  /// Returns the reference in a file, if the scene is smooth and has one; else a converged run.
  Reference referenceOf(const StudyScene& study) {
    announce(study.name + ", reference");
    if (study.isSmooth()) {
      try {
        return readReference(referenceFile(options_.scenes, study.name), study);
      } catch (const std::runtime_error& error) {
        remark(std::string(error.what()) + "; a converged run serves instead");
      }
    }
    return convergeReference(study, options_.quick ? kQuickGoal : kFullGoal);
  }

  void writeComparisons() {
    std::vector<WorkPrecisionRow> rows;
    std::vector<NamedReference> references;
    for (Compared& scene : scenes_) {
      references.push_back({scene.study.name, scene.reference.source, scene.reference.ownError});
      for (std::vector<WorkPrecisionRow>& climb : scene.climbs) {
        for (WorkPrecisionRow& row : climb) {
          judge(scene.reference, scene.study, row);
          rows.push_back(std::move(row));
        }
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
      remark(std::to_string(count) + " runs were not made, " + file("skipped.txt") + " says why");
    } else {
      std::remove(file("skipped.txt").c_str());
    }
  }

  // ---- limits of stability

  void planLimits() {
    systems_ = {makeOscillator(), makeVibratingCloth()};
    limits_.resize(systems_.size() * solverRegistry().size());
    std::size_t k = 0;
    for (const VibratingSystem& system : systems_) {
      for (const SolverInfo& method : solverRegistry()) {
        add(1, [this, &system, &method, k] {
          announce("stability, " + system.name + ", " + method.name);
          limits_[k] = measureStability(method, system);
        });
        ++k;
      }
    }
  }

  void writeLimits() const {
    writeTable(file("stability.csv"), [&](auto& out) { writeStability(out, limits_); });
    writeTable(file("stability_limits.csv"),
               [&](auto& out) { writeStabilityLimits(out, limits_); });
  }

  // ---- errors and cost at the size that people run

  void planSizes() {
    std::vector<int> sizes = options_.sizes;
    if (sizes.empty()) sizes = {16, 32};
    if (options_.sizes.empty() && !options_.quick) sizes.insert(sizes.end(), {64, 128, 256});
    std::vector<AtSizeRun> runs = atSizeRuns(sizes, options_.only);
    std::stable_sort(runs.begin(), runs.end(), [](const AtSizeRun& a, const AtSizeRun& b) {
      return a.particles > b.particles;
    });
    sizes_.resize(runs.size());
    for (std::size_t k = 0; k < runs.size(); ++k) {
      add(1, [this, k, run = runs[k]] {
        announce("at size, " + run.scene + ", " + std::to_string(run.particles) + " particles");
        sizes_[k] = run.make();
      });
    }
  }

  void writeSizes() const {
    std::vector<AtSizeRow> rows;
    for (const auto& of : sizes_) rows.insert(rows.end(), of.begin(), of.end());
    const std::vector<std::string> scenes = atSizeScenes();
    const auto place = [&scenes](const AtSizeRow& row) {
      return std::make_pair(std::find(scenes.begin(), scenes.end(), row.scene), row.particles);
    };
    std::stable_sort(rows.begin(), rows.end(),
                     [&](const AtSizeRow& a, const AtSizeRow& b) { return place(a) < place(b); });
    writeTable(file("at_size.csv"), [&](auto& out) { writeAtSize(out, rows); });
  }

  // ---- measured cloth

  void planReality() {
    reality_ = realityRuns(options_.quick);
    realityLines_.resize(reality_.size());
    for (std::size_t k = 0; k < reality_.size(); ++k) {
      add(1, [this, k] {
        announce("reality, " + reality_[k].what);
        realityLines_[k] = reality_[k].make();
      });
    }
  }

  void writeReality() const {
    const std::vector<RealityTable>& tables = realityTables();
    for (std::size_t table = 0; table < tables.size(); ++table) {
      std::string text = tables[table].header;
      for (std::size_t k = 0; k < reality_.size(); ++k) {
        if (reality_[k].table == table) text += realityLines_[k];
      }
      writeTable(file(tables[table].file), [&text](auto& out) { out << text; });
    }
  }

  // ---- influence of the resolution

  void planResolutions() {
    std::vector<ResolutionRun> runs = resolutionRuns(
        options_.quick ? std::vector<int>{16, 32, 64} : std::vector<int>{16, 32, 64, 128, 256});
    std::stable_sort(runs.begin(), runs.end(), [](const ResolutionRun& a, const ResolutionRun& b) {
      return a.particles > b.particles;
    });
    resolutions_.resize(runs.size());
    for (std::size_t k = 0; k < runs.size(); ++k) {
      add(1, [this, k, run = runs[k]] {
        announce("resolution, " + run.name + ", " + std::to_string(run.particles) + " particles");
        resolutions_[k] = run.make();
      });
    }
  }

  void writeResolutions() const {
    std::vector<ResolutionRow> rows;
    for (const auto& of : resolutions_) rows.insert(rows.end(), of.begin(), of.end());
    writeTable(file("resolution.csv"),
               [&](auto& out) { writeResolution(out, compareWithFinest(std::move(rows))); });
  }

  const StudyOptions& options_;
  StudyProgress& progress_;
  Ladder ladder_;
  Jobs jobs_;
  std::mutex mutex_;  ///< of `progress_` and `done_`
  int done_ = 0;
  int total_ = 0;
  std::vector<Compared> scenes_;  ///< not resized once jobs refer to them
  std::vector<VibratingSystem> systems_;
  std::vector<StabilityLimit> limits_;
  std::vector<std::vector<ResolutionRow>> resolutions_;
  std::vector<std::vector<AtSizeRow>> sizes_;
  std::vector<RealityRun> reality_;
  std::vector<std::string> realityLines_;  ///< by run
};

}  // namespace

std::vector<std::string> tablesOf(const StudyOptions& options) {
  std::vector<std::string> files;
  const auto add = [&](const std::string& name) { files.push_back(options.out + "/" + name); };
  if (options.atSize) add("at_size.csv");
  if (options.reality) {
    for (const RealityTable& table : realityTables()) add(table.file);
  }
  if (options.resolution) add("resolution.csv");
  if (options.stability) {
    for (const char* name : {"stability.csv", "stability_limits.csv"}) add(name);
  }
  if (options.workPrecision) {
    for (const char* name :
         {"work_precision.csv", "tearing.csv", "pareto.csv", "references.csv", "skipped.txt"}) {
      add(name);
    }
  }
  return files;
}

void runStudy(const StudyOptions& options, StudyProgress& progress) {
  Study(options, progress).run();
}

}  // namespace cloth_sim
