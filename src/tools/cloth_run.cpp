/// \file cloth_run: runs a scene without a ROS master, as fast as it can. See docs/cloth_run.md.

#include <sys/time.h>
#include <unistd.h>

#include <csignal>
#include <iostream>
#include <optional>
#include <stdexcept>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/real_time.h"
#include "cloth_sim/sim/saved_state.h"
#include "cloth_sim/sim/summary.h"
#include "cloth_sim/threads/thread_limit.h"
#include "end_of_run.h"
#include "ros/recording.h"
#include "ros/scene_path.h"
#include "run_options.h"
#include "run_progress.h"
#include "run_recorder.h"
#include "support/input_file.h"
#include "support/one_line.h"
#include "support/output_file.h"

namespace cloth_sim {
namespace {

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
    std::cerr << "cloth_run: " << options.scene << ": phase " << phaseOf(simulation)
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
      while (caughtSignal == 0 && !end.reached(*simulation_)) {
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
    std::cerr << "cloth_run: " << oneLine(error.what()) << std::endl;
    return kBadInput;
  } catch (const std::exception& error) {
    std::cerr << "cloth_run: " << oneLine(error.what()) << std::endl;
    return kOutputLost;
  }
}
