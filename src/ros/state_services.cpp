/// \file Services for the state of the simulation: save_state, load_state, get_state.

#include "cloth_sim/GetState.h"
#include "cloth_sim/LoadState.h"
#include "cloth_sim/SaveState.h"
#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/sim/saved_state.h"
#include "services.h"
#include "support/hash.h"

namespace cloth_sim {
namespace {

constexpr std::chrono::milliseconds kSaveTimeout{5000};   ///< for a pause between two steps
constexpr std::chrono::milliseconds kFiguresTimeout{50};  ///< for the figures of now

void saveState(const SaveState::Request& request, SaveState::Response& reply, Services& services) {
  reply.message = stateNameError(request.name);
  if (!reply.message.empty()) return;
  std::string bytes;
  const auto save = [&](const Simulation& simulation) {
    bytes = simulation.save();
    reply.step = simulation.stepCount();
    reply.time = simulation.time();
    reply.state_hash = hashText(stateHash(simulation.model(), simulation.state()));
  };
  const CommandResult saved = services.simulation().inspect(save, kSaveTimeout);
  reply.message = saved.message;
  if (!saved.success) return;
  try {
    reply.message = "saved as " + services.states().write(request.name, bytes);
    reply.success = true;
  } catch (const std::runtime_error& error) {
    reply.message = error.what();
  }
}

void loadState(const LoadState::Request& request, LoadState::Response& reply, Services& services) {
  reply.message = stateNameError(request.name);
  if (!reply.message.empty()) return;
  try {
    services.execute(Restore{services.states().read(request.name)}, "goes on from there", reply);
  } catch (const std::runtime_error& error) {
    reply.message = error.what();
  }
  if (!reply.success) return;
  const std::shared_ptr<const Snapshot> now = services.simulation().observe().whole;
  reply.step = now->step;
  reply.time = now->time;
  reply.state_hash = hashText(now->figures->hash);
}

void getState(GetState::Response& reply, Services& services) {
  const Observation observation = services.simulation().observeWhole(kFiguresTimeout);
  std_msgs::Header header;
  header.stamp = ros::Time::now();
  header.frame_id = services.facts().worldFrame;
  reply.success = true;
  reply.message = "ok";
  reply.state = toStateMessage(observation, header);
  reply.scene = services.facts().scene;
  reply.solver = services.facts().solver;
  reply.dt = services.facts().dt;
  if (const std::optional<Grid>& grid = observation.whole->topology->cloths.front().grid) {
    reply.columns = static_cast<std::uint32_t>(grid->columns);
    reply.rows = static_cast<std::uint32_t>(grid->rows);
  }
  for (const ClampSnapshot& clamp : observation.whole->clamps) {
    reply.clamps.push_back(clamp.name);
  }
  reply.phases = services.checker().phases();
  for (const PhaseRecord& record : observation.phases) {
    reply.history.push_back(toPhaseInfo(record));
  }
}

}  // namespace

void advertiseStateServices(Services& services) {
  services.advertise<SaveState>("save_state", [&services](const auto& request, auto& reply) {
    saveState(request, reply, services);
  });
  services.advertise<LoadState>("load_state", [&services](const auto& request, auto& reply) {
    loadState(request, reply, services);
  });
  services.advertisePrompt<GetState>(
      "get_state",
      [&services](const auto& /*request*/, auto& reply) { getState(reply, services); });
}

}  // namespace cloth_sim
