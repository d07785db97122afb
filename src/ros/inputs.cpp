#include "cloth_sim/ros/inputs.h"

#include <ros/console.h>

namespace cloth_sim {
namespace {

constexpr double kWarnPeriod = 0.5;  ///< [s]

void warn(const std::string& topic, const std::string& message) {
  ROS_WARN_STREAM_THROTTLE(kWarnPeriod, "~" << topic << ": refused: " << message);
}

}  // namespace

Inputs::Inputs(ros::NodeHandle& privateNode, const RequestChecker& checker,
               SimulationThread& simulation)
    : checker_(checker), simulation_(simulation) {
  for (const std::string& clamp : checker.clamps()) {
    const std::string base = "clamps/" + clamp;
    const boost::function<void(const geometry_msgs::PoseStamped&)> onPose =
        [this, clamp, topic = base + "/command"](const geometry_msgs::PoseStamped& pose) {
          submit(topic, checker_.clampPose(clamp, pose));
        };
    const boost::function<void(const std_msgs::Bool&)> onGrasp =
        [this, clamp, topic = base + "/grasp"](const std_msgs::Bool& grasp) {
          submit(topic, checker_.grasp(clamp, grasp.data));
        };
    // Only the newest pose counts; every grasp does.
    subscribers_.push_back(
        privateNode.subscribe<geometry_msgs::PoseStamped, const geometry_msgs::PoseStamped&>(
            base + "/command", 1, onPose));
    subscribers_.push_back(
        privateNode.subscribe<std_msgs::Bool, const std_msgs::Bool&>(base + "/grasp", 10, onGrasp));
  }
  subscribers_.push_back(privateNode.subscribe("cut_stroke", 10, &Inputs::onCutStroke, this));
  // Rays replace each other, but every release counts: a few may wait.
  subscribers_.push_back(privateNode.subscribe("drag", 10, &Inputs::onDrag, this));
  subscribers_.push_back(privateNode.subscribe("phase_command", 10, &Inputs::onPhase, this));
}

void Inputs::onCutStroke(const CutStroke& stroke) { submit("cut_stroke", checker_.stroke(stroke)); }

void Inputs::onDrag(const DragRay& ray) { submit("drag", checker_.drag(ray)); }

void Inputs::onPhase(const std_msgs::String& phase) {
  submit("phase_command", checker_.phase(phase.data));
}

void Inputs::submit(const std::string& topic, const Request& request) {
  if (const auto* refusal = std::get_if<Refusal>(&request)) {
    warn(topic, refusal->message);
    return;
  }
  simulation_.post(std::get<Command>(request), [topic](const CommandResult& result) {
    if (!result.success) warn(topic, result.message);
  });
}

}  // namespace cloth_sim
