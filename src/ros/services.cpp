#include "services.h"

#include <ros/init.h>

#include <utility>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/sim/saved_state.h"
#include "support/hash.h"

namespace cloth_sim {
namespace {

constexpr std::chrono::milliseconds kTimeout{5000};    ///< for a command between two steps
constexpr std::chrono::milliseconds kLookTimeout{50};  ///< for the figures of now
constexpr std::chrono::milliseconds kShutdownPoll{100};

/// Where the simulation stands. \param snapshot  with figures.
template <typename Reply>
void fillPlace(const Snapshot& snapshot, Reply& reply) {
  reply.step = snapshot.step;
  reply.time = snapshot.time;
  reply.state_hash = hashText(snapshot.figures->hash);
}

}  // namespace

Services::Services(ros::NodeHandle& privateNode, SceneFacts facts, const RequestChecker& checker,
                   SimulationThread& simulation, ClampPorts& clamps)
    : facts_(std::move(facts)),
      states_(facts_.stateDirectory),
      checker_(checker),
      simulation_(simulation),
      clamps_(clamps) {
  advertise<SetClampPose>(privateNode, "set_clamp_pose", &Services::setClampPose);
  advertise<Grasp>(privateNode, "grasp", &Services::grasp);
  advertise<AddClamp>(privateNode, "add_clamp", &Services::addClamp);
  advertise<RemoveClamp>(privateNode, "remove_clamp", &Services::removeClamp);
  advertise<Follow>(privateNode, "follow", &Services::track);
  advertise<Cut>(privateNode, "cut", &Services::cut);
  advertise<Refine>(privateNode, "refine", &Services::refine);
  advertise<StartPhase>(privateNode, "set_phase", &Services::setPhase);
  advertise<Pause>(privateNode, "pause", &Services::pause);
  advertise<Step>(privateNode, "step", &Services::step);
  advertise<SetRealTimeFactor>(privateNode, "set_real_time_factor", &Services::setRealTimeFactor);
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

void Services::track(const Follow::Request& request, Follow::Response& reply) {
  reply.success = false;
  reply.message = sourceError(request);
  if (!reply.message.empty()) return;
  const CommandResult result = clamps_.track(request.clamp, toPoseSource(request));
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

void Services::setRealTimeFactor(const SetRealTimeFactor::Request& request,
                                 SetRealTimeFactor::Response& reply) {
  reply.message = checker_.realTimeFactor(request.factor);
  reply.success = reply.message.empty();
  if (!reply.success) return;
  simulation_.setRealTimeFactor(request.factor);
  reply.message = "simulated time passes at that pace";
}

void Services::reset(const ResetScene::Request& request, ResetScene::Response& reply) {
  carryOut(checker_.reset(request.scope), "reset", reply);
}

void Services::saveState(const SaveState::Request& request, SaveState::Response& reply) {
  reply.message = checker_.stateName(request.name);
  if (!reply.message.empty()) return;
  std::string bytes;
  const auto look = [&](const Simulation& simulation) {
    bytes = simulation.save();
    reply.step = simulation.stepCount();
    reply.time = simulation.time();
    reply.state_hash = hashText(stateHash(simulation.model(), simulation.state()));
  };
  const CommandResult looked = simulation_.inspect(look, kTimeout);
  reply.message = looked.message;
  if (!looked.success) return;
  try {
    reply.message = "saved as " + states_.write(request.name, bytes);
    reply.success = true;
  } catch (const StateError& error) {
    reply.message = error.what();
  }
}

void Services::loadState(const LoadState::Request& request, LoadState::Response& reply) {
  reply.message = checker_.stateName(request.name);
  if (!reply.message.empty()) return;
  try {
    const Restore restore{states_.read(request.name)};
    carryOut(Request{Command{restore}}, "goes on from there", reply);
  } catch (const StateError& error) {
    reply.message = error.what();
  }
  if (reply.success) fillPlace(*simulation_.observe().whole, reply);
}

void Services::getState(const GetState::Request& /*request*/, GetState::Response& reply) {
  const Observation observation = simulation_.observeWhole(kLookTimeout);
  std_msgs::Header header;
  header.stamp = ros::Time::now();
  header.frame_id = facts_.worldFrame;
  reply.success = true;
  reply.message = "ok";
  reply.state = toStateMessage(observation, header);
  reply.scene = facts_.scene;
  reply.solver = facts_.solver;
  reply.dt = facts_.dt;
  for (const ClampSnapshot& clamp : observation.whole->clamps) {
    reply.clamps.push_back(clamp.name);
  }
  reply.phases = checker_.phases();
  for (const PhaseRecord& record : observation.phases) {
    reply.history.push_back(toPhaseInfo(record));
  }
}

}  // namespace cloth_sim
