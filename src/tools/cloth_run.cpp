/// \file cloth_run: runs a scene without a ROS master, as fast as it can. See docs/cloth_run.md.

#include <sys/time.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <optional>
#include <stdexcept>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/fabric_list.h"
#include "cloth_sim/sim/real_time.h"
#include "cloth_sim/sim/saved_state.h"
#include "cloth_sim/sim/summary.h"
#include "cloth_sim/threads/thread_limit.h"
#include "number_option.h"
#include "ros/bag_writer.h"
#include "ros/recording.h"
#include "ros/scene_path.h"
#include "status_line.h"
#include "support/input_file.h"
#include "support/output_file.h"

namespace cloth_sim {
namespace {

enum ExitCode {
  kDone = 0,
  kOutputLost = 1,
  kBadInput = 2,
  kFailed = 3,
  kDiffers = 4,
  kSignalBase = 128
};

constexpr double kDefaultDuration = 10.0;  ///< of a scene without an end of its own [s]
constexpr double kLinePeriod = 10.0;       ///< between two lines in a log, wall time [s]

struct Options {
  std::string scene;
  std::vector<std::string> overrides;
  std::optional<double> duration;  ///< [s]
  std::optional<std::string> bag;
  bool compactBag = false;
  double bagRate = 30.0;                    ///< of simulated time [Hz]
  std::optional<std::uint64_t> frameEvery;  ///< steps from frame to frame, instead of the rate
  std::optional<std::string> summary;
  std::optional<std::string> loadState;
  std::optional<std::string> saveState;
  std::optional<std::string> replay;
  int threads = 0;         ///< 0: one per processor
  bool calibrate = false;  ///< measure again what `solver.budget: real_time` means
  bool fabrics = false;    ///< print the built-in fabrics and do nothing else
};

/// A wrong command line or scene, or an output that cannot be written.
class BadInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

volatile std::sig_atomic_t caughtSignal = 0;
StopFlag isStopped{false};  ///< set by a signal: the step under way ends early

/// Time after a signal for what asks for none: cuts, refinements, and factorisations [us].
constexpr suseconds_t kStopWithin = 700000;

/// Ends the process in work that asks for no signal. Calls only what a signal handler may.
void onDeadline(int /*signal*/) {
  constexpr char kLine[] =
      "cloth_run: interrupted in work that does not stop; no output was written\n";
  const ssize_t written = write(STDERR_FILENO, kLine, sizeof kLine - 1);
  _exit(written < 0 ? kOutputLost : kSignalBase + caughtSignal);
}

void setDeadline(suseconds_t microseconds) {
  itimerval timer{};
  timer.it_value.tv_usec = microseconds;
  setitimer(ITIMER_REAL, &timer, nullptr);
}

/// The step under way ends early, and the run with it.
void onSignal(int signal) {
  caughtSignal = signal;
  isStopped = true;
  setDeadline(kStopWithin);
}

void listenToSignals() {
  std::signal(SIGALRM, onDeadline);
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
}

/// Lets the outputs take their time.
void stopListening() {
  std::signal(SIGALRM, SIG_IGN);
  setDeadline(0);
}

/// Adds the options of the bag that a run writes.
void addBagOptions(CLI::App& app, Options& options) {
  auto* bag = app.add_option("--bag", options.bag, "rosbag to write");
  auto* rate =
      app.add_option("--bag-rate", options.bagRate, "frames in the bag per simulated second [Hz]")
          ->capture_default_str()
          ->check(numberIn(0.1, 1000.0));
  app.add_option("--frame-every", options.frameEvery,
                 "steps from one frame in the bag to the next, instead of --bag-rate")
      ->needs(bag)
      ->excludes(rate)
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1000000000}));
  app.add_flag("--compact-bag", options.compactBag,
               "frames in steps of 0.1 mm, and the bag compressed: a sixth of the size\n"
               "(~compact_frame instead of ~frame)")
      ->needs(bag);
}

/// Adds the options of the command line, whose values go to `options`.
void addOptions(CLI::App& app, Options& options) {
  auto* scene = app.add_option("SCENE", options.scene,
                               "scene file, or the name of one of the package's config/scenes");
  auto* overrides = app.add_option("--set", options.overrides,
                                   "override of the scene, dotted.key=value (may be given again)")
                        ->allow_extra_args(false);
  auto* duration =
      app.add_option("--duration", options.duration,
                     "simulated time to run [s] (default: until the phases end; 10 without phases)")
          ->check(numberIn(0.0, 1e6));
  addBagOptions(app, options);
  app.add_option("--summary", options.summary, "JSON summary to write; - for standard output");
  auto* load =
      app.add_option("--load-state", options.loadState, "saved state of this scene to go on from");
  app.add_option("--save-state", options.saveState, "file for the state at the end");
  auto* replayed =
      app.add_option("--replay", options.replay,
                     "bag of the node or of cloth_run: its scene, with its commands, once more; "
                     "exit\nstatus 4 unless it leads to the recorded states, to the bit")
          ->excludes(scene)
          ->excludes(overrides)
          ->excludes(duration)
          ->excludes(load);
  app.add_option("--threads", options.threads, "0: one per processor")
      ->capture_default_str()
      ->check(CLI::Range(0, 1024));
  app.add_flag("--calibrate", options.calibrate,
               "measure the cost of a step again, for a scene with solver.budget real_time")
      ->excludes(replayed);
  app.add_flag("--fabrics", options.fabrics,
               "print the built-in fabrics as JSON, with source and spread of each value, and end");
  app.footer(
      "Exit status: 0 done; 2 bad input; 3 the simulation failed, and the summary says how;\n"
      "4 a replay came to other states than the recorded ones;\n"
      "1 the disk did not take the output; 128 + signal number if it was interrupted.");
}

/// Parses the command line. \return an exit code if the program ends here.
std::optional<int> parse(int argc, char** argv, Options& options) {
  CLI::App app("Runs a cloth_sim scene headless, without a ROS master, as fast as it can.",
               "cloth_run");
  addOptions(app, options);
  try {
    app.parse(argc, argv);
    if (options.fabrics) {
      std::cout << fabricListJson() << std::endl;
      return kDone;
    }
    if (options.scene.empty() && !options.replay) throw CLI::RequiredError("SCENE");
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    throw BadInput(std::string(error.what()) + " (see cloth_run --help)");
  }
  return std::nullopt;
}

/// Shows how far a run has come.
class Progress {
 public:
  explicit Progress(std::optional<double> duration) : duration_(duration) {}

  /// Returns the time since the start [s].
  double wallTime() const { return line_.wallTime(); }

  void update(const Simulation& simulation) {
    const std::string phase = phaseOf(simulation);
    if (phase == shownPhase_ && !line_.isDue()) return;
    shownPhase_ = phase;
    show(simulation);
  }

  void finish(const Simulation& simulation) {
    show(simulation);
    line_.keep();
  }

  static std::string phaseOf(const Simulation& simulation) {
    const auto& history = simulation.script().history();
    return history.empty() ? "" : history.back().name;
  }

 private:
  void show(const Simulation& simulation) {
    const std::string phase = phaseOf(simulation);
    const double wall = wallTime();
    char text[200];
    std::snprintf(text, sizeof(text),
                  "%-10s t %6.2f s  real-time factor %5.2f  broken %d  pieces %d",
                  phase.empty() ? "-" : phase.c_str(), simulation.time(),
                  wall > 0.0 ? simulation.time() / wall : 0.0, simulation.broken().total,
                  simulation.pieces());
    line_.show(fractionDone(simulation), text);
  }

  /// Returns the fraction of the time, or of the phases if the run has no duration.
  double fractionDone(const Simulation& simulation) const {
    if (duration_) return *duration_ > 0.0 ? simulation.time() / *duration_ : 1.0;
    const PhaseScript& script = simulation.script();
    if (script.status() == ScriptStatus::kDone) return 1.0;
    if (script.history().empty()) return 0.0;
    return (static_cast<double>(script.history().size()) - 1.0) /
           static_cast<double>(simulation.scene().phases.size());
  }

  std::optional<double> duration_;
  StatusLine line_{kLinePeriod};
  std::string shownPhase_;
};

/// Writes frames to a bag, at their rate or every few steps, and at every change of phase.
class Recorder {
 public:
  Recorder(const Options& options, const std::string& scene)
      : writer_(*options.bag, scene,
                options.compactBag ? FrameFormat::kCompact : FrameFormat::kFull),
        every_(options.frameEvery),
        period_(1.0 / options.bagRate) {}

  void update(Simulation& simulation, double wallTime) {
    append(simulation.takeEvents(), events_);
    append(simulation.takeGripEvents(), grips_);
    if (written_ == simulation.stepCount()) return;  // the step was stopped
    const std::string phase = Progress::phaseOf(simulation);
    if (!isDue(simulation) && phase == phase_) return;
    phase_ = phase;
    write(simulation, wallTime);
  }

  void note(const CommandRecord& command) { writer_.write(command); }

  void finish(Simulation& simulation, double wallTime) {
    const bool told = events_.empty() && grips_.empty();
    if (written_ != simulation.stepCount() || !told) write(simulation, wallTime);
    writer_.close();
  }

 private:
  /// Tells whether it is time for a frame. \post the next one is due later.
  bool isDue(const Simulation& simulation) {
    if (every_) return simulation.stepCount() % *every_ == 0;
    const double half = 0.5 * simulation.scene().solver.dt;
    if (simulation.time() + half < next_) return false;
    while (next_ <= simulation.time() + half) next_ += period_;
    return true;
  }

  void write(Simulation& simulation, double wallTime) {
    Observation observation;
    observation.whole = observation.snapshot = simulation.snapshot();
    observation.phases = simulation.script().history();
    const auto steps = static_cast<double>(simulation.stepCount());
    observation.realTimeFactor = wallTime > 0.0 ? simulation.time() / wallTime : 0.0;
    observation.stepTime = steps > 0.0 ? wallTime / steps : 0.0;
    writer_.write(observation, events_, grips_);
    events_.clear();
    grips_.clear();
    written_ = simulation.stepCount();
  }

  template <typename Event>
  static void append(const std::vector<Event>& more, std::vector<Event>& events) {
    events.insert(events.end(), more.begin(), more.end());
  }

  BagWriter writer_;
  std::optional<std::uint64_t> every_;  ///< steps; absent: `period_` counts
  double period_;                       ///< [s]
  double next_ = 0.0;                   ///< simulated time of the next frame [s]
  std::string phase_;
  std::vector<FailureEvent> events_;
  std::vector<GripEvent> grips_;
  std::optional<std::uint64_t> written_;  ///< step of the last frame
};

/// Decides when a run is over.
class EndOfRun {
 public:
  /// \param start  simulated time at which the run begins [s].
  EndOfRun(std::optional<double> duration, double start) {
    if (duration) end_ = start + *duration;
  }

  bool reached(const Simulation& simulation) {
    const PhaseScript& script = simulation.script();
    if (caughtSignal != 0 || simulation.failed()) return true;
    if (script.status() == ScriptStatus::kFailed) return true;
    if (end_) return passed(simulation, *end_);
    if (script.status() == ScriptStatus::kDone) return true;
    if (script.status() == ScriptStatus::kIdle && !simulation.scene().phases.empty()) return false;
    return isEndless(script) && passed(simulation, phaseStart(script) + kDefaultDuration);
  }

 private:
  static bool passed(const Simulation& simulation, double time) {
    return simulation.time() >= time - 0.5 * simulation.scene().solver.dt;
  }
  /// Tells whether there is no script, or a phase that only a command ends.
  static bool isEndless(const PhaseScript& script) {
    const PhaseSpec* phase = script.current();
    return phase == nullptr || (phase->until.none() && !phase->timeout);
  }
  static double phaseStart(const PhaseScript& script) {
    return script.history().empty() ? 0.0 : script.history().back().start;
  }

  std::optional<double> end_;  ///< [s]
};

/// Finds out before a long run whether an output can be written.
/// \param file  null if the user named none.
std::optional<OutputFile> placeFor(const std::optional<std::string>& file) {
  if (!file) return std::nullopt;
  return OutputFile(*file);
}

/// Writes a line for each doubt about the result.
void reportWarnings(const Options& options, const Simulation& simulation) {
  for (const ResultWarning& warning : simulation.warnings()) {
    std::cerr << "cloth_run: " << options.scene << ": warning: " << warning.text << std::endl;
  }
}

/// Writes one line if the run did not succeed. \return the exit code.
int report(const Options& options, const Simulation& simulation) {
  if (simulation.failed()) {
    std::cerr << "cloth_run: " << options.scene
              << ": the simulation failed at t = " << simulation.time()
              << " s: " << simulation.failure() << std::endl;
    return kFailed;
  }
  if (simulation.script().status() == ScriptStatus::kFailed) {
    std::cerr << "cloth_run: " << options.scene << ": phase " << Progress::phaseOf(simulation)
              << " ran into its time-out" << std::endl;
    return kFailed;
  }
  if (caughtSignal != 0) {
    std::cerr << "cloth_run: interrupted at t = " << simulation.time() << " s" << std::endl;
    return kSignalBase + caughtSignal;
  }
  return kDone;
}

/// Writes the choice of `method: auto` on one line.
void reportChoice(const SolverSpec& solver) {
  if (!solver.choice) return;
  std::cerr << "cloth_run: solver auto, error " << solver.choice->error << ": " << solver.method
            << ", dt " << solver.dt;
  for (const auto& [name, value] : solver.parameters) std::cerr << ", " << name << ' ' << value;
  std::cerr << " (" << solver.choice->source << ')' << std::endl;
}

/// Loads the scene of the command line, with a budget for this machine if it asks for real time.
Scene loadForRun(const Options& options) {
  CalibrationSettings settings;
  settings.threads = options.threads;
  settings.again = options.calibrate;
  settings.tell = [](const std::string& line) { std::cerr << "cloth_run: " << line << std::endl; };
  Scene scene =
      loadForThisMachine(loaderOf(resolveScene(options.scene), options.overrides), settings);
  if (options.calibrate && !scene.solver.realTimeBudget) {
    throw SceneError(options.scene + ": --calibrate: expected solver.budget real_time");
  }
  return scene;
}

std::unique_ptr<Simulation> buildSimulation(const Options& options,
                                            const std::optional<Recording>& recording) {
  try {
    Scene scene = recording ? parseScene(recording->scene, *options.replay) : loadForRun(options);
    reportChoice(scene.solver);
    return std::make_unique<Simulation>(std::move(scene));
  } catch (const std::invalid_argument& error) {  // of the simulation, which knows no files
    throw BadInput((recording ? *options.replay : options.scene) + ": " + error.what());
  } catch (const std::exception& error) {
    throw BadInput(error.what());
  }
}

/// Returns the commands of a replay, or the one that loads a saved state.
std::vector<CommandRecord> initialCommands(const Options& options,
                                           const std::optional<Recording>& recording) {
  if (recording) return recording->commands;
  if (!options.loadState) return {};
  const InputRules rules{kMaxStateSize, Links::kFollowed};
  return {{0, 0, 0.0, Restore{readInputFile(*options.loadState, rules)}}};
}

/// Goes on from a saved state. \param command  of `initialCommands`.
void loadState(const Options& options, const CommandRecord& command, Simulation& simulation) {
  const CommandResult loaded = simulation.apply(command.command);
  if (!loaded.success) throw BadInput(*options.loadState + ": " + loaded.message);
}

/// Opens the bag and writes the commands. \return null if there is no bag.
std::unique_ptr<Recorder> openBag(const Options& options, const Simulation& simulation,
                                  const std::vector<CommandRecord>& commands) {
  if (!options.bag) return nullptr;
  auto recorder = std::make_unique<Recorder>(options, simulation.scene().text);
  for (const CommandRecord& command : commands) recorder->note(command);
  return recorder;
}

std::optional<Recording> openRecording(const std::optional<std::string>& bag) {
  if (!bag) return std::nullopt;
  try {
    return readRecording(*bag);
  } catch (const std::runtime_error& error) {
    throw BadInput(error.what());
  }
}

/// Reports in one line whether the replay reproduced the recorded states.
int report(const Options& options, const Recording& recording, const Replay& outcome) {
  const std::string reproduced = std::to_string(outcome.same) + " of " +
                                 std::to_string(recording.states.size()) +
                                 " recorded states were reproduced";
  if (caughtSignal != 0) {
    std::cerr << "cloth_run: interrupted; " << reproduced << std::endl;
    return kSignalBase + caughtSignal;
  }
  if (!outcome.difference.empty()) {
    std::cerr << "cloth_run: " << *options.replay << ": " << outcome.difference << "; "
              << reproduced
              << ". Another version of cloth_sim may have recorded them: see CHANGELOG.rst"
              << std::endl;
    return kDiffers;
  }
  std::cerr << "cloth_run: " << *options.replay << ": " << reproduced << ", the last with the hash "
            << recording.states.back().hash << std::endl;
  return kDone;
}

/// A run from the command line: the simulation with its record, bag and progress.
class Run {
 public:
  explicit Run(const Options& options)
      : options_(options),
        limit_(options.threads),
        recording_(openRecording(options.replay)),
        simulation_(buildSimulation(options, recording_)),
        record_(startRecord(*simulation_)) {
    const std::vector<CommandRecord> commands = initialCommands(options, recording_);
    if (!recording_ && !commands.empty()) {
      loadState(options, commands.front(), *simulation_);
      record_.piecesAtStart = simulation_->pieces();
    }
    summary_ = placeFor(options.summary);
    saveState_ = placeFor(options.saveState);
    recorder_ = openBag(options, *simulation_, commands);
  }

  /// Runs to the end and writes the outputs. \return the exit code.
  int execute() {
    listenToSignals();
    simulation_->stopWhen(isStopped);
    Progress progress(options_.duration);
    if (recorder_) recorder_->update(*simulation_, 0.0);
    const auto afterStep = [&] { return observeStep(progress); };
    std::optional<Replay> outcome;
    if (recording_) {
      outcome = replay(*recording_, *simulation_, afterStep);
    } else {
      EndOfRun end(options_.duration, simulation_->time());
      while (!end.reached(*simulation_)) {
        simulation_->step();
        afterStep();
      }
    }
    stopListening();
    const double wallTime = progress.wallTime();
    progress.finish(*simulation_);
    writeOutputs(wallTime);
    reportWarnings(options_, *simulation_);
    return outcome ? report(options_, *recording_, *outcome) : report(options_, *simulation_);
  }

 private:
  /// \return false if the run was interrupted.
  bool observeStep(Progress& progress) {
    if (summary_) {
      simulation_->observeMaxStretch();
      observe(*simulation_, record_);
    }
    if (recorder_) recorder_->update(*simulation_, progress.wallTime());
    progress.update(*simulation_);
    return caughtSignal == 0;
  }

  void writeOutputs(double wallTime) {
    if (recorder_) recorder_->finish(*simulation_, wallTime);
    if (saveState_) saveState_->write(simulation_->save());
    if (!summary_) return;
    summary_->write(summaryJson(*simulation_, record_, wallTime, caughtSignal != 0) + '\n');
  }

  const Options& options_;
  ThreadLimit limit_;
  std::optional<Recording> recording_;  ///< of a replay
  std::unique_ptr<Simulation> simulation_;
  RunRecord record_;
  std::optional<OutputFile> summary_;
  std::optional<OutputFile> saveState_;
  std::unique_ptr<Recorder> recorder_;  ///< null without a bag
};

/// \throws BadInput if the run cannot begin, though not for want of space.
std::unique_ptr<Run> makeRun(const Options& options) {
  try {
    return std::make_unique<Run>(options);
  } catch (const FileError& error) {
    if (error.isOutOfSpace()) throw;
    throw BadInput(error.what());
  }
}

}  // namespace
}  // namespace cloth_sim

int main(int argc, char** argv) {
  using namespace cloth_sim;
  reportOutputErrors();
  try {
    Options options;
    if (const std::optional<int> code = parse(argc, argv, options)) return *code;
    return makeRun(options)->execute();
  } catch (const BadInput& error) {
    std::cerr << "cloth_run: " << error.what() << std::endl;
    return kBadInput;
  } catch (const std::exception& error) {
    std::cerr << "cloth_run: " << error.what() << std::endl;
    return kOutputLost;
  }
}
