#pragma once
/// \file The command line of cloth_run.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "cloth_sim/sim/fabric_list.h"
#include "number_option.h"

namespace cloth_sim {

/// Exit statuses of cloth_run.
enum ExitCode {
  kDone = 0,
  kOutputLost = 1,
  kBadInput = 2,
  kFailed = 3,
  kDiffers = 4,
  kSignalBase = 128
};

/// Values of the command line.
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

/// Adds the options of the bag that a run writes.
inline void addBagOptions(CLI::App& app, Options& options) {
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
inline void addOptions(CLI::App& app, Options& options) {
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
inline std::optional<int> parse(int argc, char** argv, Options& options) {
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

}  // namespace cloth_sim
