#include "cloth_sim/ros/services.h"

#include <ros/init.h>

#include <utility>

#include "cloth_sim/ros/conversions.h"

namespace cloth_sim {
namespace {

constexpr std::chrono::milliseconds kTimeout{5000};  ///< for a command between two steps
constexpr std::chrono::milliseconds kShutdownPoll{100};

/// Puts "not available" in the reply unless the request is already refused.
template <typename Reply>
void notAvailable(const std::string& refusal, const std::string& what, Reply& reply) {
  reply.success = false;
  reply.message = refusal.empty() ? what + " is not available in this version" : refusal;
}

}  // namespace

Services::Services(ros::NodeHandle& privateNode, SceneFacts facts, const RequestChecker& checker,
                   SimulationThread& simulation, ClampPorts& clamps)
    : facts_(std::move(facts)), checker_(checker), simulation_(simulation), clamps_(clamps) {
  advertise<SetClampPose>(privateNode, "set_clamp_pose", &Services::setClampPose);
  advertise<Grasp>(privateNode, "grasp", &Services::grasp);
  advertise<AddClamp>(privateNode, "add_clamp", &Services::addClamp);
  advertise<RemoveClamp>(privateNode, "remove_clamp", &Services::removeClamp);
  advertise<Follow>(privateNode, "follow", &Services::follow);
  advertise<Cut>(privateNode, "cut", &Services::cut);
  advertise<Refine>(privateNode, "refine", &Services::refine);
  advertise<StartPhase>(privateNode, "set_phase", &Services::setPhase);
  advertise<Pause>(privateNode, "pause", &Services::pause);
  advertise<Step>(privateNode, "step", &Services::step);
  advertise<ResetScene>(privateNode, "reset", &Services::reset);
  advertise<SaveState>(privateNode, "save_state", &Services::saveState);
  advertise<LoadState>(privateNode, "load_state", &Services::loadState);
  advertise<GetState>(privateNode, "get_state", &Services::getState);
}

template <typename Service>
void Services::advertise(ros::NodeHandle& node, const std::string& name,
                         void (Services::*handler)(const typename Service::Request&,
                                                   typename Service::Response&)) {
  using Arguments = typename Service::Request;
  using Reply = typename Service::Response;
  const boost::function<bool(Arguments&, Reply&)> callback = [this, handler](Arguments& request,
                                                                             Reply& reply) {
    (this->*handler)(request, reply);
    return true;
  };
  servers_.push_back(node.advertiseService<Arguments, Reply>(name, callback));
}

/// Has the command carried out, or passes on why not.
template <typename Reply>
void Services::carryOut(const Request& request, const std::string& done, Reply& reply) {
  if (const auto* refusal = std::get_if<Refusal>(&request)) {
    reply.success = false;
    reply.message = refusal->message;
    return;
  }
  const CommandResult result = simulation_.execute(std::get<Command>(request), kTimeout);
  reply.success = result.success;
  reply.message = result.success && result.message.empty() ? done : result.message;
}

void Services::setClampPose(const SetClampPose::Request& request, SetClampPose::Response& reply) {
  carryOut(checker_.clampPose(request.clamp, request.pose),
           "clamp " + request.clamp + " goes there", reply);
}

void Services::grasp(const Grasp::Request& request, Grasp::Response& reply) {
  carryOut(checker_.grasp(request.clamp, request.grasp),
           "clamp " + request.clamp + (request.grasp ? " closes" : " has let go"), reply);
}

/// Its topics are there when the reply is.
void Services::addClamp(const AddClamp::Request& request, AddClamp::Response& reply) {
  carryOut(checker_.newClamp(request), "clamp " + request.name + " is there", reply);
  clamps_.update(simulation_.observe());
}

void Services::removeClamp(const RemoveClamp::Request& request, RemoveClamp::Response& reply) {
  carryOut(Request{Command{DeleteClamp{request.clamp}}}, "clamp " + request.clamp + " is gone",
           reply);
  clamps_.update(simulation_.observe());
}

void Services::follow(const Follow::Request& request, Follow::Response& reply) {
  reply.success = false;
  reply.message = followDefect(request);
  if (!reply.message.empty()) return;
  const CommandResult result = clamps_.follow(request.clamp, toFollowSource(request));
  reply.success = result.success;
  reply.message = result.message;
}

void Services::cut(const Cut::Request& request, Cut::Response& reply) {
  carryOut(checker_.stroke(request.stroke), "cut", reply);
}

void Services::refine(const Refine::Request& request, Refine::Response& reply) {
  carryOut(checker_.refinement(request), "refined", reply);
}

void Services::setPhase(const StartPhase::Request& request, StartPhase::Response& reply) {
  carryOut(checker_.phase(request.phase), "phase " + request.phase + " has begun", reply);
}

void Services::pause(const Pause::Request& request, Pause::Response& reply) {
  simulation_.setPaused(request.paused);
  reply.success = true;
  reply.message = request.paused ? "paused" : "running";
}

void Services::step(const Step::Request& request, Step::Response& reply) {
  reply.success = false;
  reply.message = checker_.steps(request.steps);
  if (!reply.message.empty()) return;
  std::future<StepResult> future = simulation_.requestSteps(static_cast<int>(request.steps));
  while (future.wait_for(kShutdownPoll) != std::future_status::ready) {
    if (ros::isShuttingDown()) return;  // nobody is left to answer to
  }
  const StepResult done = future.get();
  reply.success = done.result.success;
  reply.message = done.result.success ? "made " + std::to_string(request.steps) + " steps"
                                      : done.result.message;
  reply.step = done.step;
  reply.time = done.time;
}

void Services::reset(const ResetScene::Request& /*request*/, ResetScene::Response& reply) {
  carryOut(Request{Command{Reset{}}}, "back at the start of the scene", reply);
}

void Services::saveState(const SaveState::Request& request, SaveState::Response& reply) {
  notAvailable(checker_.stateName(request.name), "saving the state", reply);
}

void Services::loadState(const LoadState::Request& request, LoadState::Response& reply) {
  notAvailable(checker_.stateName(request.name), "loading a state", reply);
}

void Services::getState(const GetState::Request& /*request*/, GetState::Response& reply) {
  const Observation observation = simulation_.observe();
  std_msgs::Header header;
  header.stamp = ros::Time::now();
  header.frame_id = facts_.worldFrame;
  reply.success = true;
  reply.message = "ok";
  reply.state = toStateMessage(observation, header);
  reply.scene = facts_.scene;
  reply.solver = facts_.solver;
  reply.dt = facts_.dt;
  for (const ClampSnapshot& clamp : observation.snapshot->clamps) {
    reply.clamps.push_back(clamp.name);
  }
  reply.phases = checker_.phases();
  for (const PhaseRecord& record : observation.phases) {
    reply.history.push_back(toPhaseInfo(record));
  }
}

}  // namespace cloth_sim
