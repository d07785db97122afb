#include "cloth_sim/ros/node.h"

#include <ros/init.h>
#include <ros/names.h>
#include <ros/spinner.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <csignal>
#include <iostream>

#include "cloth_sim/ros/actions.h"
#include "cloth_sim/ros/clock_publisher.h"
#include "cloth_sim/ros/handles.h"
#include "cloth_sim/ros/inputs.h"
#include "cloth_sim/ros/live_parameters.h"
#include "cloth_sim/ros/publishers.h"
#include "cloth_sim/ros/scene_path.h"
#include "cloth_sim/ros/services.h"
#include "cloth_sim/scene/load.h"

namespace cloth_sim {
namespace {

constexpr int kBadInput = 2;
constexpr int kCallbackThreads = 4;  ///< so that a long ~step does not hold up the other services
constexpr double kTfTimeout = 0.2;   ///< for a transform that is about to arrive [s]
constexpr double kTfPoll = 0.005;    ///< [s]

/// What ROS does on SIGINT, on SIGTERM too: `kill` ends the node as cleanly as Ctrl-C.
void onTerminate(int /*signal*/) { ros::requestShutdown(); }

Scene loadNodeScene(const NodeParameters& parameters) {
  Scene scene = loadScene(resolveScene(parameters.scene), parameters.set);
  for (const ClampSpec& clamp : scene.clamps) {
    std::string error;
    if (clamp.name.find('/') != std::string::npos || !ros::names::validate(clamp.name, error)) {
      throw SceneError(parameters.scene +
                       ": clamps: expected names that ROS topics can have (got '" + clamp.name +
                       "')");
    }
  }
  return scene;
}

/// Waits by the wall's clock: with simulated time, a paused simulation would make it wait for ever.
void waitForTransform(const tf2_ros::Buffer& buffer, const std::string& world,
                      const std_msgs::Header& header) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kTfTimeout);
  while (!buffer.canTransform(world, header.frame_id, header.stamp) && ros::WallTime::now() < end) {
    ros::WallDuration(kTfPoll).sleep();
  }
}

/// Looks poses up in tf; those in the world frame already need none.
WorldTransform worldTransform(const tf2_ros::Buffer& buffer, const std::string& world) {
  return [&buffer, world](const Pose& pose, const std_msgs::Header& header) -> Pose {
    if (header.frame_id.empty()) throw std::runtime_error("header.frame_id is empty");
    if (header.frame_id == world || header.frame_id == "/" + world) return pose;
    waitForTransform(buffer, world, header);
    const geometry_msgs::TransformStamped found =
        buffer.lookupTransform(world, header.frame_id, header.stamp);
    const geometry_msgs::Vector3& shift = found.transform.translation;
    const Pose frame{Vec3(shift.x, shift.y, shift.z),
                     fromQuaternion(found.transform.rotation).normalized()};
    return {frame.toWorld(pose.position), (frame.orientation * pose.orientation).normalized()};
  };
}

/// Everything that lives as long as the node does; members are taken down in reverse order.
class Node {
 public:
  Node(ros::NodeHandle& node, ros::NodeHandle& privateNode, const NodeParameters& parameters,
       const Scene& scene)
      : listener_(buffer_),
        checker_(scene, worldTransform(buffer_, parameters.worldFrame)),
        clock_(node, parameters.publishClock),
        simulation_(scene, runSettings(parameters)),
        publishers_(node, privateNode, parameters, scene.text, simulation_),
        services_(privateNode,
                  {scene.name, scene.solver.method, scene.solver.dt, parameters.worldFrame,
                   parameters.stateDirectory},
                  checker_, simulation_),
        actions_(privateNode, checker_, simulation_),
        inputs_(privateNode, checker_, simulation_),
        liveParameters_(privateNode, scene, simulation_) {
    if (parameters.handles) {
      handles_ =
          std::make_unique<Handles>(privateNode, parameters.worldFrame, checker_, simulation_);
    }
  }

  /// Lets callbacks that wait for the simulation go.
  void stop() { simulation_.stop(); }

 private:
  RunSettings runSettings(const NodeParameters& parameters) {
    RunSettings settings{parameters.realTimeFactor, parameters.paused, parameters.threads};
    settings.onTime = [this](double time) { clock_.tell(time); };
    return settings;
  }

  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  RequestChecker checker_;
  ClockPublisher clock_;
  SimulationThread simulation_;
  Publishers publishers_;
  Services services_;
  Actions actions_;
  Inputs inputs_;
  LiveParameters liveParameters_;
  std::unique_ptr<Handles> handles_;  ///< if asked for
};

}  // namespace

int runNode(int argc, char** argv) {
  try {
    ros::init(argc, argv, "cloth");
    std::signal(SIGTERM, onTerminate);
    ros::NodeHandle handle;
    ros::NodeHandle privateHandle("~");
    const NodeParameters parameters = readParameters(privateHandle);
    Node node(handle, privateHandle, parameters, loadNodeScene(parameters));
    ros::AsyncSpinner spinner(kCallbackThreads);
    spinner.start();
    ros::waitForShutdown();
    node.stop();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "cloth_node: " << error.what() << std::endl;
    return kBadInput;
  }
}

}  // namespace cloth_sim
