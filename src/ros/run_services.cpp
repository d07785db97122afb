/// \file Services that steer the run: set_phase, pause, step, set_real_time_factor, reset,
/// set_resolution.

#include <ros/init.h>

#include "cloth_sim/ChangeResolution.h"
#include "cloth_sim/Pause.h"
#include "cloth_sim/ResetScene.h"
#include "cloth_sim/SetRealTimeFactor.h"
#include "cloth_sim/StartPhase.h"
#include "cloth_sim/Step.h"
#include "services.h"

namespace cloth_sim {
namespace {

constexpr std::chrono::milliseconds kShutdownPoll{100};

void pause(const Pause::Request& request, Pause::Response& reply, SimulationThread& simulation) {
  simulation.setPaused(request.paused != 0);
  reply.success = true;
  reply.message = request.paused ? "paused" : "running";
}

void step(const Step::Request& request, Step::Response& reply, SimulationThread& simulation) {
  reply.success = false;
  reply.message = stepCountError(request.steps);
  if (!reply.message.empty()) return;
  std::future<StepResult> future = simulation.requestSteps(static_cast<int>(request.steps));
  while (future.wait_for(kShutdownPoll) != std::future_status::ready) {
    if (ros::isShuttingDown()) return;  // nobody is left to answer to
  }
  const StepResult made = future.get();
  reply.success = made.result.success;
  reply.message = made.result.success ? "made " + std::to_string(request.steps) + " steps"
                                      : made.result.message;
  reply.step = made.step;
  reply.time = made.time;
}

void setRealTimeFactor(const SetRealTimeFactor::Request& request,
                       SetRealTimeFactor::Response& reply, SimulationThread& simulation) {
  reply.message = realTimeFactorError(request.factor);
  reply.success = reply.message.empty();
  if (!reply.success) return;
  simulation.setRealTimeFactor(request.factor);
  reply.message = "simulated time passes at that pace";
}

}  // namespace

void advertiseRunServices(Services& services) {
  services.advertise<StartPhase>("set_phase", [&services](const auto& request, auto& reply) {
    services.execute(SetPhase{request.phase}, "phase " + request.phase + " has begun", reply);
  });
  services.advertisePrompt<Pause>("pause", [&services](const auto& request, auto& reply) {
    pause(request, reply, services.simulation());
  });
  services.advertise<Step>("step", [&services](const auto& request, auto& reply) {
    step(request, reply, services.simulation());
  });
  services.advertisePrompt<SetRealTimeFactor>(
      "set_real_time_factor", [&services](const auto& request, auto& reply) {
        setRealTimeFactor(request, reply, services.simulation());
      });
  services.advertise<ResetScene>("reset", [&services](const auto& request, auto& reply) {
    services.execute(services.checker().reset(request.scope), "reset", reply);
  });
  services.advertise<ChangeResolution>(
      "set_resolution", [&services](const auto& request, auto& reply) {
        services.execute(services.checker().resolution(request.columns), "reset", reply);
      });
}

}  // namespace cloth_sim
