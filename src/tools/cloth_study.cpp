/// \file cloth_study: compares the methods on the same scenes. See docs/cloth_study.md.

#include <ros/package.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/real_time.h"
#include "cloth_sim/threads/thread_limit.h"
#include "number_option.h"
#include "ros/scene_path.h"
#include "status_line.h"
#include "study/advise.h"
#include "study/exact.h"
#include "study/make_auto_table.h"
#include "study/study.h"
#include "support/input_file.h"
#include "support/one_line.h"
#include "support/output_file.h"

namespace cloth_sim {
namespace {

namespace fs = std::filesystem;

enum ExitCode { kDone = 0, kFailed = 1, kBadInput = 2 };

constexpr std::uint64_t kMaxTableSize = 1ULL << 30;  ///< [bytes]
constexpr double kLinePeriod = 5.0;                  ///< between two lines in a log, wall time [s]

const char* const kWorkPrecision = "work_precision";
const char* const kStability = "stability";
const char* const kResolution = "resolution";
const char* const kAtSize = "at_size";
const char* const kReality = "reality";

struct Options {
  bool quick = false;
  bool charts = true;
  int jobs = 1;
  std::string out;
  std::vector<std::string> scenes;
  std::vector<int> sizes;  ///< particles per side of at_size; empty: the study's own
  std::vector<std::string> parts{kWorkPrecision, kStability, kResolution};
  std::string references;  ///< folder for new references; "": none
  std::string autoTable;   ///< file to write; "": none
  bool cache = false;      ///< keep the advice in the user's cache
  std::string advise;      ///< scene; "": none
  double error = 0.01;     ///< largest error for the advice [-]
  double duration = 1.0;   ///< simulated time of each run for the advice [s]
  double budget = 120.0;   ///< CPU time for the advice [s]
};

/// A wrong command line, or a folder that cannot be used.
class BadInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Adds the options of a study.
void addStudyOptions(CLI::App& app, Options& options) {
  app.add_option("--out", options.out, "folder for tables and charts (created if missing)");
  app.add_flag("--quick", options.quick, "shorter ladders of substeps: two minutes");
  app.add_option(
         "--jobs", options.jobs,
         "number of runs at the same time, each in a thread of its own (timings are CPU times\n"
         "of threads; use no more jobs than idle cores)")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  app.add_option("--scenes", options.scenes, "only these of the study's scenes, a,b,...")
      ->delimiter(',');
  app.add_option("--parts", options.parts,
                 "some of work_precision, stability, resolution, at_size and reality\n"
                 "(default: the first three)")
      ->delimiter(',')
      ->check(CLI::IsMember({kWorkPrecision, kStability, kResolution, kAtSize, kReality}));
  app.add_option("--sizes", options.sizes,
                 "only these numbers of particles per side in at_size, a,b,... (default: 16, 32,\n"
                 "64, 128, 256; above 128 only the swing runs)")
      ->delimiter(',')
      ->check(CLI::Range(8, 512));
  app.add_flag("!--no-charts", options.charts, "only the tables");
  app.add_option(
      "--make-references", options.references,
      "only make the references of the smooth scenes, with SUNDIALS CVODE, in this folder");
  app.add_option("--make-auto-table", options.autoTable,
                 "only write the table of 'solver: {method: auto}' from the tables in --out");
}

/// Adds the options of advice on a scene.
void addAdviceOptions(CLI::App& app, Options& options) {
  app.add_option("--advise", options.advise,
                 "scene file, or name of one of the package's: find the cheapest method, step and\n"
                 "substeps for it, and the parts of it that can be left out");
  app.add_option("--error", options.error,
                 "largest error for the advice: of positions over the cloth's side, or (if the\n"
                 "cloth comes apart) of the time of separation")
      ->capture_default_str()
      ->check(numberIn(1e-9, 1.0));
  app.add_option("--duration", options.duration, "simulated time of each run for the advice [s]")
      ->capture_default_str()
      ->check(numberIn(1e-3, 1e4));
  app.add_flag(
      "--cache", options.cache,
      "advise on the solver only, and keep the result for 'solver: {method: auto}' of this\n"
      "scene on this machine");
  app.add_option("--budget", options.budget, "CPU time after which the advice begins no run [s]")
      ->capture_default_str()
      ->check(numberIn(1.0, 1e6));
}

/// Parses the command line. \return an exit code if the program ends here.
std::optional<int> parse(int argc, char** argv, Options& options) {
  CLI::App app(
      "Compares every method of cloth_sim on the same scenes: cost against error, limits of\n"
      "stability, and the influence of the resolution. Writes CSV tables and charts.",
      "cloth_study");
  addStudyOptions(app, options);
  addAdviceOptions(app, options);
  app.footer("Exit status: 0 done; 2 bad input; 1 something failed, and the last line says what.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    throw BadInput(std::string(error.what()) + " (see cloth_study --help)");
  }
  const int asked = !options.out.empty() + !options.references.empty() + !options.advise.empty();
  if (asked != 1) {
    throw BadInput(
        "expected one of --out DIR, --advise SCENE and --make-references DIR (see cloth_study "
        "--help)");
  }
  return std::nullopt;
}

/// Shows how far a study has come.
class Progress final : public StudyProgress {
 public:
  void update(int done, int total, const std::string& next) override {
    if (done < total && !line_.isDue()) return;
    const double fraction = static_cast<double>(done) / total;
    line_.show(fraction, percent(fraction) + timed(next));
    if (done == total) line_.keep();
  }

  /// Shows the progress of work whose length is not known.
  void mention(int done, const std::string& next) {
    if (line_.isDue()) line_.show(std::nullopt, std::to_string(done) + "  " + timed(next));
  }
  void clear() const { line_.clear(); }

  void remark(const std::string& text) override {
    line_.clear();
    std::fprintf(stderr, "cloth_study: %s\n", text.c_str());
  }

 private:
  static std::string percent(double fraction) {
    char text[16];
    std::snprintf(text, sizeof(text), "%3d %%  ", static_cast<int>(100.0 * fraction));
    return text;
  }
  std::string timed(const std::string& next) const {
    return std::to_string(std::lround(line_.wallTime())) + " s  " + next;
  }

  StatusLine line_{kLinePeriod};
};

fs::path packageFolder() {
  const std::string package = ros::package::getPath("cloth_sim");
  if (package.empty()) {
    throw BadInput("the package cloth_sim is not on ROS_PACKAGE_PATH, so its scenes are not found");
  }
  return package;
}

/// Makes the folder of the output, so that it cannot fail only after a long run.
void makeFolder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder) || access(folder.c_str(), W_OK) != 0) {
    throw BadInput(folder + ": cannot be written to");
  }
}

/// Finds out whether an output can be written, so that it cannot fail only after a long run.
OutputFile placeFor(const std::string& file, bool onlyRegular = false) {
  try {
    return OutputFile(file, {Links::kFollowed, onlyRegular});
  } catch (const FileError& error) {
    if (error.isOutOfSpace()) throw;
    throw BadInput(error.what());
  }
}

/// Quotes a text for the shell.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

/// Draws the charts. The script reports missing packages.
void drawCharts(const std::string& folder) {
  const fs::path script = packageFolder() / "study" / "plots.py";
  const std::string command = "/usr/bin/python3 " + quoted(script) + " " + quoted(folder);
  if (std::system(command.c_str()) != 0) {
    throw std::runtime_error("the charts could not be drawn; the tables are in " + folder);
  }
}

int makeReferences(const std::string& folder) {
  if (!canIntegrateExactly()) {
    throw BadInput(
        "--make-references: this was built without SUNDIALS CVODE 6 or later (Debian: "
        "libsundials-dev)");
  }
  makeFolder(folder);
  for (const std::string& name : studySceneNames()) {
    const StudyScene study = loadStudyScene(packageFolder() / "config" / "study", name);
    if (!study.isSmooth()) continue;
    const std::string file = referenceFile(folder, name);
    OutputFile place = placeFor(file);
    std::ostringstream out;
    writeReference(out, study, integrateExactly(study));
    place.write(out.str());
    std::cout << file << std::endl;
  }
  return kDone;
}

/// Keeps the advice for `solver: {method: auto}` of the same scene.
void keepAdvice(const Advice& advice) {
  const std::string file = autoCacheFile();
  if (file.empty()) throw std::runtime_error("--cache: expected HOME or CLOTH_SIM_CACHE to be set");
  const Scene& scene = advice.study.scene;
  AutoCache(file).add(scene.contentKey, advice.bound,
                      withConfiguration(scene, advice.best->configuration).solver);
  std::cout << "kept in " << file << std::endl;
}

int adviseOn(const Options& options) {
  const std::string scene = resolveScene(options.advise);
  AdviceRequest request;
  CalibrationSettings calibrations;
  calibrations.tell = [](const std::string& line) { std::cerr << line << std::endl; };
  request.load = [&](const auto& overrides) {
    return loadForThisMachine(loaderOf(scene, overrides), calibrations);
  };
  request.bound = options.error;
  request.duration = options.duration;
  request.budget = options.budget;
  request.simplify = !options.cache;
  int done = 0;
  Progress progress;
  const Announce announce = [&](const std::string& next) { progress.mention(++done, next); };
  const Advice advice = advise(request, announce);
  progress.clear();
  writeAdvice(std::cout, advice, options.advise);
  if (advice.reference.ownError > options.error) {
    progress.remark("the run that all are compared with is itself no better than " +
                    std::to_string(advice.reference.ownError) +
                    ": this scene is not predictable to the error that was asked for");
  }
  if (advice.best && options.cache) keepAdvice(advice);
  return advice.best ? kDone : kFailed;
}

std::istringstream openTable(const std::string& file) {
  try {
    return std::istringstream(readInputFile(file, {kMaxTableSize, Links::kFollowed}));
  } catch (const FileError& error) {
    throw BadInput(error.what());
  }
}

int makeAutoTableFrom(const Options& options) {
  std::vector<StudyScene> scenes;
  for (const std::string& name : studySceneNames()) {
    scenes.push_back(loadStudyScene(packageFolder() / "config" / "study", name));
  }
  OutputFile place = placeFor(options.autoTable);
  std::istringstream runs = openTable(options.out + "/work_precision.csv");
  std::istringstream references = openTable(options.out + "/references.csv");
  const AutoTable table = makeAutoTable(scenes, readWorkPrecision(runs), readOwnErrors(references));
  std::ostringstream out;
  writeAutoTable(out, table,
                 "Choices of solver: {method: auto}; src/scene/auto_method.h documents the\n"
                 "columns. Made by: cloth_study --out DIR --parts work_precision\n"
                 "and cloth_study --out DIR --make-auto-table config/auto_methods.csv");
  place.write(out.str());
  std::cout << options.autoTable << std::endl;
  return kDone;
}

int run(const Options& options) {
  const ThreadLimit oneThread(1);
  if (!options.references.empty()) return makeReferences(options.references);
  if (!options.advise.empty()) return adviseOn(options);
  if (!options.autoTable.empty()) return makeAutoTableFrom(options);
  makeFolder(options.out);
  const std::set<std::string> parts(options.parts.begin(), options.parts.end());
  StudyOptions study;
  study.quick = options.quick;
  study.scenes = packageFolder() / "config" / "study";
  study.out = options.out;
  study.only = options.scenes;
  study.sizes = options.sizes;
  study.jobs = options.jobs;
  study.workPrecision = parts.count(kWorkPrecision) != 0;
  study.stability = parts.count(kStability) != 0;
  study.resolution = parts.count(kResolution) != 0;
  study.atSize = parts.count(kAtSize) != 0;
  study.reality = parts.count(kReality) != 0;
  for (const std::string& file : tablesOf(study)) placeFor(file, true);
  Progress progress;
  runStudy(study, progress);
  if (options.charts) drawCharts(options.out);
  std::cout << (options.charts ? "tables and charts: " : "tables: ") << options.out << std::endl;
  return kDone;
}

}  // namespace
}  // namespace cloth_sim

int main(int argc, char** argv) {
  using namespace cloth_sim;
  reportOutputErrors();
  try {
    Options options;
    if (const std::optional<int> code = parse(argc, argv, options)) return *code;
    return run(options);
  } catch (const BadInput& error) {
    std::cerr << "cloth_study: " << oneLine(error.what()) << std::endl;
    return kBadInput;
  } catch (const SceneError& error) {
    std::cerr << "cloth_study: " << oneLine(error.what()) << std::endl;
    return kBadInput;
  } catch (const std::exception& error) {
    std::cerr << "cloth_study: " << oneLine(error.what()) << std::endl;
    return kFailed;
  }
}
