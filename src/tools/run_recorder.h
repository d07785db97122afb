#pragma once
/// \file The bag of a run of cloth_run.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cloth_sim/sim/simulation.h"
#include "ros/bag_writer.h"
#include "run_options.h"
#include "run_progress.h"

namespace cloth_sim {

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
    const std::string phase = phaseOf(simulation);
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

}  // namespace cloth_sim
