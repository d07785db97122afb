/// \file cloth_study: compares the methods on the same scenes. See docs/cloth_study.md.

#include <ros/package.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <set>
#include <stdexcept>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/threads/thread_limit.h"
#include "ros/scene_path.h"
#include "study/advise.h"
#include "study/exact.h"
#include "study/make_auto_table.h"
#include "study/study.h"

namespace cloth_sim {
namespace {

namespace fs = std::filesystem;

enum ExitCode { kDone = 0, kFailed = 1, kBadInput = 2 };

constexpr double kBarPeriod = 0.1;   ///< of redrawing the bar, wall time [s]
constexpr double kLinePeriod = 5.0;  ///< of plain lines, wall time [s]
constexpr int kBarWidth = 24;        ///< [characters]

const char* const kWorkPrecision = "work_precision";
const char* const kStability = "stability";
const char* const kResolution = "resolution";

struct Options {
  bool quick = false;
  bool charts = true;
  int jobs = 1;
  std::string out;
  std::vector<std::string> scenes;
  std::vector<std::string> parts{kWorkPrecision, kStability, kResolution};
  std::string references;  ///< "": do not make them
  std::string autoTable;   ///< file to write; "": none
  bool cache = false;      ///< the advice goes into the user's cache
  std::string advise;      ///< scene; "": none
  double error = 0.01;     ///< that the advice shall keep
  double duration = 1.0;   ///< of the scene that is looked at for that [s]
  double budget = 120.0;   ///< CPU time for that [s]
};

/// A wrong command line, or a folder that cannot be used.
class BadInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Fills `options`. \return an exit code if the program ends here.
std::optional<int> parse(int argc, char** argv, Options& options) {
  CLI::App app(
      "Compares every method of cloth_sim on the same scenes: cost against error, limits of\n"
      "stability, and what depends on the resolution. Writes CSV tables and charts.",
      "cloth_study");
  app.add_option("--out", options.out, "folder for tables and charts (made if it is not there)");
  app.add_flag("--quick", options.quick, "shorter ladders of substeps: two minutes");
  app.add_option("--jobs", options.jobs,
                 "runs at the same time, each in a thread of its own (timings are of threads, but\n"
                 "give it no more than there are quiet cores)")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  app.add_option("--scenes", options.scenes, "only these of the study's scenes, a,b,...")
      ->delimiter(',');
  app.add_option("--parts", options.parts,
                 "work_precision, stability and resolution, or some of it")
      ->delimiter(',')
      ->check(CLI::IsMember({kWorkPrecision, kStability, kResolution}));
  app.add_flag("!--no-charts", options.charts, "only the tables");
  app.add_option("--make-references", options.references,
                 "make the references of the smooth scenes anew, with SUNDIALS CVODE, into this\n"
                 "folder, and nothing else");
  app.add_option(
      "--make-auto-table", options.autoTable,
      "write the table of 'solver: {method: auto}' from the tables in --out, and nothing\n"
      "else");
  app.add_option("--advise", options.advise,
                 "scene file, or name of one of the package's: says which method, step and\n"
                 "substeps it needs, and what it can do without");
  app.add_option("--error", options.error,
                 "error that the advice shall keep: of positions over the cloth's side, or\n"
                 "(where it comes apart) of the time of separation")
      ->capture_default_str()
      ->check(CLI::Range(1e-9, 1.0));
  app.add_option("--duration", options.duration, "of the scene, for the advice [s]")
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e4));
  app.add_flag(
      "--cache", options.cache,
      "advise on the solver only, and keep that for 'solver: {method: auto}' of this scene,\n"
      "on this machine");
  app.add_option("--budget", options.budget,
                 "CPU time after which the advice tries nothing new [s]")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e6));
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

/// Shows how far the study is: a bar on a terminal, otherwise a line now and then.
class Progress final : public StudyProgress {
 public:
  void update(int done, int total, const std::string& next) override {
    const double now = wallTime();
    if (done < total && now - shown_ < (terminal_ ? kBarPeriod : kLinePeriod)) return;
    shown_ = now;
    if (terminal_) {
      const int filled = kBarWidth * done / total;
      std::fprintf(stderr, "\r[%s%s] %3d %%  %.0f s  %s\033[K", std::string(filled, '#').c_str(),
                   std::string(kBarWidth - filled, '.').c_str(), 100 * done / total, now,
                   next.c_str());
      if (done == total) std::fputc('\n', stderr);
    } else {
      std::fprintf(stderr, "%3d %%  %.0f s  %s\n", 100 * done / total, now, next.c_str());
    }
    std::fflush(stderr);
  }

  /// Of something that nobody knows the length of.
  void mention(int done, const std::string& next) {
    const double now = wallTime();
    if (!terminal_ && now - shown_ < kLinePeriod) return;
    shown_ = now;
    std::fprintf(stderr, terminal_ ? "\r%d  %.0f s  %s\033[K" : "%d  %.0f s  %s\n", done, now,
                 next.c_str());
    std::fflush(stderr);
  }
  void clear() const {
    if (terminal_) std::fputs("\r\033[K", stderr);
  }

  void remark(const std::string& text) override {
    std::fprintf(stderr, "%scloth_study: %s\n", terminal_ ? "\r\033[K" : "", text.c_str());
  }

 private:
  using Clock = std::chrono::steady_clock;

  double wallTime() const {  ///< since the start [s]
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }

  bool terminal_ = isatty(STDERR_FILENO) != 0;
  Clock::time_point start_ = Clock::now();
  double shown_ = -1e9;  ///< wall time of the last output [s]
};

fs::path packageFolder() {
  const std::string package = ros::package::getPath("cloth_sim");
  if (package.empty()) {
    throw BadInput("the package cloth_sim is not on ROS_PACKAGE_PATH, so its scenes are not found");
  }
  return package;
}

/// An output must not fail only after a long run.
void makeFolder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder) || access(folder.c_str(), W_OK) != 0) {
    throw BadInput(folder + ": cannot be written to");
  }
}

/// For the shell.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

/// Draws the charts. The script says what it lacks.
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
    std::ofstream out(file);
    writeReference(out, study, integrateExactly(study));
    out.close();
    if (!out) throw std::runtime_error(file + ": cannot be written");
    std::cout << file << std::endl;
  }
  return kDone;
}

/// For `solver: {method: auto}` of the same scene.
void keepAdvice(const Advice& advice) {
  const std::string file = userCacheFile();
  if (file.empty()) throw std::runtime_error("--cache: expected HOME or CLOTH_SIM_CACHE to be set");
  const Scene& scene = advice.study.scene;
  AutoCache(file).add(scene.contentKey, advice.bound,
                      withConfiguration(scene, advice.best->configuration).solver);
  std::cout << "kept in " << file << std::endl;
}

int adviseOn(const Options& options) {
  const std::string scene = resolveScene(options.advise);
  AdviceRequest request;
  request.load = [scene](const auto& overrides) { return loadScene(scene, overrides); };
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

std::ifstream openTable(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw BadInput(file + ": cannot be read");
  return in;
}

int makeAutoTableFrom(const Options& options) {
  std::vector<StudyScene> scenes;
  for (const std::string& name : studySceneNames()) {
    scenes.push_back(loadStudyScene(packageFolder() / "config" / "study", name));
  }
  std::ifstream runs = openTable(options.out + "/work_precision.csv");
  std::ifstream references = openTable(options.out + "/references.csv");
  const AutoTable table = makeAutoTable(scenes, readWorkPrecision(runs), readOwnErrors(references));
  const std::string temporary = options.autoTable + ".tmp";
  std::ofstream out(temporary);
  writeAutoTable(
      out, table,
      "Choices of solver: {method: auto}; src/scene/auto_method.h documents the\n"
      "columns. Made by: cloth_study --out DIR --parts work_precision\n"
      "and cloth_study --out DIR --make-auto-table config/auto_methods.csv");
  out.close();
  if (!out || std::rename(temporary.c_str(), options.autoTable.c_str()) != 0) {
    std::remove(temporary.c_str());
    throw std::runtime_error(options.autoTable + ": cannot be written");
  }
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
  study.jobs = options.jobs;
  study.workPrecision = parts.count(kWorkPrecision) != 0;
  study.stability = parts.count(kStability) != 0;
  study.resolution = parts.count(kResolution) != 0;
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
  try {
    Options options;
    if (const std::optional<int> code = parse(argc, argv, options)) return *code;
    return run(options);
  } catch (const BadInput& error) {
    std::cerr << "cloth_study: " << error.what() << std::endl;
    return kBadInput;
  } catch (const SceneError& error) {
    std::cerr << "cloth_study: " << error.what() << std::endl;
    return kBadInput;
  } catch (const std::exception& error) {
    std::cerr << "cloth_study: " << error.what() << std::endl;
    return kFailed;
  }
}
