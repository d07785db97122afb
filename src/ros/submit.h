#pragma once
/// \file Hands requests from topics to the simulation.

#include <ros/console.h>

#include <string>

#include "requests.h"
#include "simulation_thread.h"

namespace cloth_sim {

/// Hands a request to the simulation, and warns if it is refused, here or there: at most twice a
/// second.
/// \param topic  named in the warning.
inline void submit(const std::string& topic, const Request& request, SimulationThread& simulation) {
  constexpr double kWarnPeriod = 0.5;  // [s]
  if (const auto* refusal = std::get_if<Refusal>(&request)) {
    ROS_WARN_STREAM_THROTTLE(kWarnPeriod, "~" << topic << ": refused: " << refusal->message);
    return;
  }
  simulation.post(std::get<Command>(request), [topic](const CommandResult& result) {
    if (result.success) return;
    ROS_WARN_STREAM_THROTTLE(kWarnPeriod, "~" << topic << ": refused: " << result.message);
  });
}

}  // namespace cloth_sim
