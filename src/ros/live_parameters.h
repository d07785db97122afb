#pragma once
/// \file Parameters that may be turned while the node runs, by dynamic_reconfigure.

#include <dynamic_reconfigure/server.h>
#include <ros/node_handle.h>
#include <ros/steady_timer.h>

#include <chrono>
#include <string>
#include <vector>

#include "cloth_sim/ClothConfig.h"
#include "simulation_thread.h"

namespace cloth_sim {

/// What stands still while parameters are turned.
struct SceneTuning {
  Vec3 down = -Vec3::UnitZ();  ///< direction of gravity, unit
  std::optional<Wind> wind;    ///< of the scene
};
SceneTuning sceneTuning(const Scene& scene);

/// The parameters of a simulation as it is now, within their ranges.
ClothConfig toConfig(const Tuning& tuning);

/// Limits in proportion to those of `ratio`, so that the weakest kind fails at `strain`. Kinds that
/// never fail never do; where none does, structural and shear springs fail at `strain`.
TearRatios scaledRatios(const TearRatios& ratio, double strain);

/// The commands that bring a simulation from one configuration to another: one for each thing that
/// differs, none for what does not.
/// \param now  of the simulation.
std::vector<Command> commandsBetween(const ClothConfig& before, const ClothConfig& after,
                                     const Tuning& now, const SceneTuning& scene);

/// Names of the parameters: `gravity`, `wind_x`, ...
std::vector<std::string> liveParameterNames();

/// Serves ~set_parameters, ~parameter_descriptions and ~parameter_updates. What the phases of the
/// scene, a reset or others' commands turn shows in the parameters, too.
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
  boost::recursive_mutex mutex_;  ///< the server's, too: of what is below
  ClothConfig config_;            ///< the last one
  Clock::time_point changed_;     ///< when a client changed it last
  dynamic_reconfigure::Server<ClothConfig> server_;
  ros::SteadyTimer timer_;
};

}  // namespace cloth_sim
