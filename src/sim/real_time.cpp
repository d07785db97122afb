#include "cloth_sim/sim/real_time.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "cloth_sim/scene/build.h"
#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/saved_state.h"
#include "cloth_sim/sim/simulation.h"
#include "cloth_sim/threads/thread_limit.h"
#include "scene/auto_method.h"
#include "support/cpu_clock.h"
#include "support/csv.h"
#include "support/output_file.h"
#include "support/user_cache.h"

namespace cloth_sim {
namespace {

constexpr int kMostSubsteps = 100000;
constexpr std::size_t kMostRows = 1000;

// ---- measurement

constexpr int kFew = 5;           ///< substeps
constexpr int kMany = 25;         ///< substeps
constexpr int kWarmUp = 2;        ///< steps that are not timed
constexpr int kFewestSteps = 3;   ///< timed steps of each kind
constexpr int kMostSteps = 50;    ///< timed steps of each kind
constexpr double kLongest = 0.6;  ///< CPU time after which no more than the fewest are taken [s]

/// A simulation whose steps are timed.
class TimedSteps {
 public:
  TimedSteps(Scene scene, int substeps) : simulation_(withSubsteps(std::move(scene), substeps)) {
    for (int k = 0; k < kWarmUp; ++k) simulation_.step();
  }

  void step() {
    const double start = threadCpuTime();
    simulation_.step();
    shortest_ = std::min(shortest_, threadCpuTime() - start);
    if (!simulation_.failed()) return;
    throw std::runtime_error("solver.budget: real_time cannot be measured: " +
                             simulation_.failure());
  }

  /// CPU time of this thread in the quickest step [s]: the wall time on a machine that has nothing
  /// else to do, because this thread works or spins throughout a step. Other programs only add to
  /// it.
  double shortest() const { return shortest_; }

 private:
  static Scene withSubsteps(Scene scene, int substeps) {
    SolverSpec& solver = scene.solver;
    solver.parameters = completeParameters(findSolver(solver.method), {{"substeps", substeps}});
    solver.realTimeBudget.reset();
    solver.guard = StepGuard::kAllow;
    solver.sleep.reset();
    return scene;
  }

  Simulation simulation_;
  double shortest_ = std::numeric_limits<double>::infinity();
};

// ---- the file

const std::vector<std::string> kColumns{"machine", "method",   "threads",   "particles",
                                        "springs", "plates",   "obstacles", "wind",
                                        "step_s",  "substep_s"};

struct Row {
  std::string key;  ///< CalibrationKey::text
  StepCost cost;
};

/// Joins the fields that are the key of a row.
std::string keyIn(const CsvRow& fields) {
  std::string text;
  for (std::size_t k = 0; k + 2 < kColumns.size(); ++k) {
    text += (k == 0 ? "" : ",") + fields.text(kColumns[k]);
  }
  return text;
}

Row toRow(const CsvRow& fields) {
  Row row{keyIn(fields), {fields.number("step_s"), fields.positive("substep_s")}};
  if (!(row.cost.perStep >= 0.0) || !std::isfinite(row.cost.perStep + row.cost.perSubstep)) {
    throw std::invalid_argument("expected times of steps [s]");
  }
  return row;
}

std::vector<Row> readRows(const std::string& file) {
  std::vector<Row> rows;
  std::ifstream in(file);
  if (!in) return rows;
  try {
    readCsv(in, kColumns, [&](const CsvRow& fields) { rows.push_back(toRow(fields)); });
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
  return rows;
}

/// Returns the rows, or none if the file is none of calibrations.
std::vector<Row> rowsOrNone(const std::string& file) {
  try {
    return readRows(file);
  } catch (const std::runtime_error&) {
    return {};
  }
}

std::string textOf(const std::vector<Row>& rows) {
  std::ostringstream out;
  out << "# Written by cloth_sim; see solver.budget in docs/scene.md. It may be deleted.\n";
  for (std::size_t k = 0; k < kColumns.size(); ++k) out << (k == 0 ? "" : ",") << kColumns[k];
  out << '\n' << std::setprecision(17);
  for (const Row& row : rows) {
    out << row.key << ',' << row.cost.perStep << ',' << row.cost.perSubstep << '\n';
  }
  return out.str();
}

/// Returns the name of this machine, without what separates fields.
std::string hostName() {
  char name[256] = "";
  if (gethostname(name, sizeof name - 1) != 0) return "unknown";
  std::string text = name;
  text.erase(std::remove_if(text.begin(), text.end(),
                            [](char c) { return c == ',' || c == '"' || c == '#'; }),
             text.end());
  return text.empty() ? "unknown" : text;
}

// ---- loading

/// Returns the cost that the file has for a key.
std::optional<StepCost> findKnown(const CalibrationSettings& settings, const CalibrationKey& key) {
  if (settings.again) return std::nullopt;
  try {
    return settings.file.find(key);
  } catch (const std::runtime_error& error) {
    settings.tell(std::string(error.what()) + "; it is measured again");
    return std::nullopt;
  }
}

void keep(const CalibrationSettings& settings, const CalibrationKey& key, const StepCost& cost) {
  try {
    settings.file.add(key, cost);
  } catch (const std::runtime_error& error) {
    settings.tell(std::string(error.what()) + "; it will be measured again next time");
  }
}

std::string describe(int substeps, const StepCost& cost, int threads, const Scene& scene,
                     const std::string& source) {
  char text[200];
  std::snprintf(text, sizeof text,
                "solver.budget real_time: %d substeps in a step of %.3g ms (%.3g ms each and %.3g "
                "ms besides, in %.0f %% of it; threads: %d; ",
                substeps, 1e3 * scene.solver.dt, 1e3 * cost.perSubstep, 1e3 * cost.perStep,
                100.0 * realTimeFraction(scene), threads);
  return text + source + ")";
}

}  // namespace

double realTimeFraction(const Scene& scene) {
  return classOf(scene) == SceneClass::kSmooth ? 0.8 : 0.6;
}

int substepsIn(double time, const StepCost& cost) {
  const double fit = (time - cost.perStep) / cost.perSubstep;
  return static_cast<int>(std::clamp(std::floor(fit), 1.0, 1.0 * kMostSubsteps));
}

StepCost measureStepCost(Scene scene) {
  TimedSteps few(scene, kFew);
  TimedSteps many(std::move(scene), kMany);
  const double end = threadCpuTime() + kLongest;
  for (int k = 0; k < kFewestSteps || (k < kMostSteps && threadCpuTime() < end); ++k) {
    few.step();
    many.step();
  }
  const double each = (many.shortest() - few.shortest()) / (kMany - kFew);
  if (each <= 0.0) return {0.0, many.shortest() / kMany};  // too short to be told apart
  return {std::max(0.0, few.shortest() - kFew * each), each};
}

std::string CalibrationKey::text() const {
  std::ostringstream out;
  out << machine << ',' << method << ',' << threads << ',' << particles << ',' << springs << ','
      << plates << ',' << obstacles << ',' << (wind ? 1 : 0);
  return out.str();
}

CalibrationKey calibrationKeyOf(const Scene& scene, int threads) {
  const ThreadLimit limit(threads);
  const Model model = buildModel(scene.cloths);
  CalibrationKey key;
  key.machine = hostName();
  key.method = scene.solver.method;
  key.threads = ThreadLimit::ofThisThread();
  key.particles = static_cast<int>(model.particleCount());
  key.springs = static_cast<int>(model.springs.count());
  key.plates = static_cast<int>(model.bending.elements().size());
  key.obstacles = static_cast<int>(scene.obstacles.size());
  key.wind = scene.wind.has_value();
  return key;
}

CalibrationFile CalibrationFile::ofUser() {
  return CalibrationFile(userCacheFile("real_time.csv"));
}

std::optional<StepCost> CalibrationFile::find(const CalibrationKey& key) const {
  std::optional<StepCost> found;
  if (file_.empty()) return found;
  for (const Row& row : readRows(file_)) {
    if (row.key == key.text()) found = row.cost;
  }
  return found;
}

void CalibrationFile::add(const CalibrationKey& key, const StepCost& cost) const {
  if (file_.empty()) return;
  std::vector<Row> rows = rowsOrNone(file_);
  const auto isSame = [name = key.text()](const Row& row) { return row.key == name; };
  rows.erase(std::remove_if(rows.begin(), rows.end(), isSame), rows.end());
  if (rows.size() >= kMostRows) rows.erase(rows.begin());
  rows.push_back({key.text(), cost});
  std::error_code ignored;
  std::filesystem::create_directories(std::filesystem::path(file_).parent_path(), ignored);
  OutputFile(file_).write(textOf(rows));
}

SceneLoader loaderOf(const std::string& path, const std::vector<std::string>& overrides) {
  return [path, overrides](const std::vector<std::string>& more) {
    std::vector<std::string> all = overrides;
    all.insert(all.end(), more.begin(), more.end());
    return loadScene(path, all);
  };
}

Scene loadForThisMachine(const SceneLoader& load, const CalibrationSettings& settings) {
  Scene scene = load({});
  const std::optional<int>& known = scene.solver.realTimeBudget;
  if (!known || (*known != 0 && !settings.again)) return scene;
  const CalibrationKey key = calibrationKeyOf(scene, settings.threads);
  std::optional<StepCost> cost = findKnown(settings, key);
  const std::string source = cost ? settings.file.file() : "measured now";
  if (!cost) {
    const ThreadLimit limit(settings.threads);
    cost = measureStepCost(scene);
    keep(settings, key, *cost);
  }
  const int substeps = substepsIn(realTimeFraction(scene) * scene.solver.dt, *cost);
  settings.tell(describe(substeps, *cost, key.threads, scene, source));
  return load({"solver.budget={real_time: " + std::to_string(substeps) + "}"});
}

}  // namespace cloth_sim
