#pragma once
/// \file Progress of a run of cloth_run on the terminal or in a log.

#include <cstdio>
#include <optional>
#include <string>

#include "cloth_sim/sim/simulation.h"
#include "status_line.h"

namespace cloth_sim {

/// Returns the name of the phase under way, or of the last one; empty if there was none.
inline std::string phaseOf(const Simulation& simulation) {
  const auto& history = simulation.script().history();
  return history.empty() ? "" : history.back().name;
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

 private:
  static constexpr double kLinePeriod = 10.0;  ///< between two lines in a log, wall time [s]

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

}  // namespace cloth_sim
