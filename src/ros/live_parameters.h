#pragma once
/// \file Parameters that may change while the node runs, by dynamic_reconfigure.

#include <dynamic_reconfigure/server.h>
#include <ros/node_handle.h>
#include <ros/steady_timer.h>

#include <chrono>
#include <string>
#include <vector>

#include "cloth_sim/ClothConfig.h"
#include "simulation_thread.h"

namespace cloth_sim {

/// The settings of a scene that parameters do not change.
struct SceneTuning {
  Vec3 down = -Vec3::UnitZ();  ///< direction of gravity, unit
  std::optional<Wind> wind;    ///< of the scene
};
SceneTuning sceneTuning(const Scene& scene);

/// Returns the current parameters of a simulation, clamped to their ranges.
ClothConfig toConfig(const Tuning& tuning);

/// Returns the limits `ratio`, scaled so that the weakest kind of spring fails at `strain`. Kinds
/// without a limit keep none; if no kind has one, structural and shear springs fail at `strain`.
TearRatios scaledRatios(const TearRatios& ratio, double strain);

/// Returns the commands that bring a simulation from one configuration to another, one for each
/// setting that differs.
/// \param now  the present settings of the simulation.
std::vector<Command> commandsBetween(const ClothConfig& before, const ClothConfig& after,
                                     const Tuning& now, const SceneTuning& scene);

/// A parameter that can be changed while the node runs.
struct LiveParameter {
  std::string name;       ///< `gravity`, `wind_x`, ...
  bool isSwitch = false;  ///< true or false; otherwise a number
};
std::vector<LiveParameter> listLiveParameters();

/// Serves ~set_parameters, ~parameter_descriptions and ~parameter_updates. The parameters also show
/// changes by phases of the scene, by a reset and by other commands.
class LiveParameters {
 public:
  LiveParameters(const ros::NodeHandle& privateNode, const Scene& scene,
                 SimulationThread& simulation);

 private:
  using Clock = std::chrono::steady_clock;

  void onChange(ClothConfig& config, std::uint32_t level);
  void mirror();

  SceneTuning scene_;
  SimulationThread& simulation_;
  boost::recursive_mutex mutex_;  ///< guards the members below, and the server
  ClothConfig config_;            ///< the last configuration
  Clock::time_point changed_;     ///< time of the last change by a client
  dynamic_reconfigure::Server<ClothConfig> server_;
  ros::SteadyTimer timer_;
};

}  // namespace cloth_sim
