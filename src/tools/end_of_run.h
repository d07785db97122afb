#pragma once
/// \file The end of a run of cloth_run.

#include <optional>

#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {

/// Decides when a run is over.
class EndOfRun {
 public:
  /// \param start  simulated time at which the run begins [s].
  EndOfRun(std::optional<double> duration, double start) {
    if (duration) end_ = start + *duration;
  }

  bool reached(const Simulation& simulation) {
    const PhaseScript& script = simulation.script();
    if (simulation.failed()) return true;
    if (script.status() == ScriptStatus::kFailed) return true;
    if (end_) return passed(simulation, *end_);
    if (script.status() == ScriptStatus::kDone) return true;
    if (script.status() == ScriptStatus::kIdle && !simulation.scene().phases.empty()) return false;
    return isEndless(script) && passed(simulation, phaseStart(script) + kDefaultDuration);
  }

 private:
  static constexpr double kDefaultDuration = 10.0;  ///< of a scene without an end of its own [s]

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

}  // namespace cloth_sim
