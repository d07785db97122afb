#include "node.h"

#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/names.h>
#include <ros/spinner.h>
#include <tf2_ros/transform_listener.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <optional>
#include <thread>

#include "actions.h"
#include "camera_topic.h"
#include "clamp_ports.h"
#include "clock_publisher.h"
#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/real_time.h"
#include "handles.h"
#include "inputs.h"
#include "live_parameters.h"
#include "master_watch.h"
#include "obstacle_trackers.h"
#include "publishers.h"
#include "robot_loader.h"
#include "robot_trackers.h"
#include "scene/names.h"
#include "scene_path.h"
#include "services.h"
#include "support/output_file.h"

namespace cloth_sim {
namespace {

constexpr int kBadInput = 2;
constexpr int kEditCutShort = 1;
constexpr std::chrono::milliseconds kStopWithin{500};  ///< from a signal to the end of an edit
constexpr std::chrono::milliseconds kLoadingPoll{20};
constexpr std::chrono::milliseconds kShutdownPoll{10};
constexpr int kCallbackThreads = 4;  ///< so that a long ~step does not block other services

/// Ends the node on SIGTERM as ROS does on SIGINT, so that `kill` is as clean as Ctrl-C.
void onTerminate(int /*signal*/) { ros::requestShutdown(); }

/// Ends the process if ROS shuts down while the scene is being loaded and built, which nothing can
/// stop. There is nothing to lose yet.
class LoadingWatch {
 public:
  LoadingWatch() : thread_([this] { watch(); }) {}
  ~LoadingWatch() {
    isLoaded_ = true;
    thread_.join();
  }
  LoadingWatch(const LoadingWatch&) = delete;
  LoadingWatch& operator=(const LoadingWatch&) = delete;

 private:
  void watch() const {
    while (!isLoaded_) {
      if (!ros::ok() && !ros::isStarted()) std::_Exit(0);  // it has told the master
      std::this_thread::sleep_for(kLoadingPoll);
    }
  }

  std::atomic<bool> isLoaded_{false};
  std::thread thread_;  // last: starts when everything above is there
};

/// Returns as soon as ROS begins to shut down. It then takes up to a second to tell the master, and
/// waits for callbacks, which may wait for the simulation.
void awaitShutdown() {
  while (ros::ok() && !ros::isShuttingDown()) std::this_thread::sleep_for(kShutdownPoll);
}

/// Ends the process if a cut or another edit that is under way does not let it end in time, once
/// ROS has told the master. (Steps are stopped.)
class ShutdownDeadline {
 public:
  explicit ShutdownDeadline(std::chrono::milliseconds allowed)
      : thread_([this, allowed] { await(allowed); }) {}
  ~ShutdownDeadline() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      met_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  ShutdownDeadline(const ShutdownDeadline&) = delete;
  ShutdownDeadline& operator=(const ShutdownDeadline&) = delete;

 private:
  void await(std::chrono::milliseconds allowed) {
    std::unique_lock<std::mutex> lock(mutex_);
    const auto isMet = [this] { return met_; };
    if (changed_.wait_for(lock, allowed, isMet)) return;
    while (ros::isStarted()) {
      if (changed_.wait_for(lock, kShutdownPoll, isMet)) return;
    }
    std::cerr << "cloth_node: the edit under way took too long; ended in the middle of it"
              << std::endl;
    std::_Exit(kEditCutShort);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool met_ = false;
  std::thread thread_;  // last: starts when everything above is there
};

/// Returns the overrides of the scene: the obstacles of the robot, which those of users may change.
std::vector<std::string> overridesFor(const NodeParameters& parameters, const Robot& robot) {
  std::vector<std::string> all = overridesOf(robot.obstacles);
  all.insert(all.end(), parameters.set.begin(), parameters.set.end());
  return all;
}

Scene loadNodeScene(const NodeParameters& parameters, const Robot& robot) {
  CalibrationSettings settings;
  settings.threads = parameters.threads;
  settings.tell = [](const std::string& line) { ROS_INFO_STREAM(line); };
  const std::string file = resolveScene(parameters.scene);
  Scene scene = loadForThisMachine(loaderOf(file, overridesFor(parameters, robot)), settings);
  if (parameters.robot) checkRobot(robot, loadScene(file), scene);
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

/// \throws ParameterError if ~follow_obstacle names an obstacle that is not in the scene.
void checkTrackedObstacles(const NodeParameters& parameters, const Scene& scene) {
  std::vector<std::string> known;
  for (const Obstacle& obstacle : scene.obstacles) known.push_back(obstacle.name);
  for (const auto& [name, source] : parameters.obstacleSources) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw ParameterError("~follow_obstacle: " + unknownName("obstacle", name, known));
  }
}

/// Receives transforms in a thread of its own, because callbacks wait for them. The thread sleeps
/// until one arrives; that of tf2_ros would poll a hundred times a second.
class TransformReceiver {
 public:
  TransformReceiver() : node_(withQueue(queue_)), listener_(buffer_, node_, false) {
    spinner_.start();
  }

  const tf2_ros::Buffer& buffer() const { return buffer_; }

 private:
  static ros::NodeHandle withQueue(ros::CallbackQueue& queue) {
    ros::NodeHandle node;
    node.setCallbackQueue(&queue);
    return node;
  }

  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  ros::AsyncSpinner spinner_{1, &queue_};
};

/// All parts of the node; they are destroyed in reverse order.
class Node {
 public:
  Node(ros::NodeHandle& node, ros::NodeHandle& privateNode, const NodeParameters& parameters,
       const Scene& scene, const Robot& robot)
      : parameters_(parameters),
        world_(transforms_.buffer(), parameters.worldFrame),
        checker_(scene,
                 [this](const Pose& pose, const std_msgs::Header& header) {
                   return world_.toWorld(pose, header);
                 }),
        clock_(node, parameters.publishClock),
        simulation_(scene, runSettings(parameters)),
        clamps_(privateNode, parameters_, checker_, world_, simulation_),
        obstacles_(privateNode, parameters_, world_, simulation_),
        robot_(privateNode, robot, parameters.rateTracking, world_, simulation_),
        camera_(privateNode, parameters.camera, world_),
        publishers_(node, privateNode, parameters, scene.text, simulation_,
                    {clamps_, obstacles_, robot_, camera_}),
        services_(privateNode,
                  {scene.name, scene.solver.method, scene.solver.dt, parameters.worldFrame,
                   parameters.stateDirectory},
                  checker_, simulation_, clamps_),
        actions_(privateNode, checker_, simulation_),
        inputs_(privateNode, checker_, simulation_),
        liveParameters_(privateNode, scene, simulation_) {
    if (parameters.handles) {
      handles_ =
          std::make_unique<Handles>(privateNode, parameters.worldFrame, checker_, simulation_);
    }
    watch_ = std::make_unique<MasterWatch>(node);
  }

  /// Releases callbacks that wait for the simulation.
  void stop() { simulation_.stop(); }

 private:
  RunSettings runSettings(const NodeParameters& parameters) {
    RunSettings settings{parameters.realTimeFactor, parameters.paused, parameters.threads};
    settings.onTime = [this](double time) { clock_.tell(time); };
    settings.onWarning = [](const std::string& warning) { ROS_WARN_STREAM(warning); };
    return settings;
  }

  TransformReceiver transforms_;
  NodeParameters parameters_;
  WorldFrame world_;
  RequestChecker checker_;
  ClockPublisher clock_;
  SimulationThread simulation_;
  ClampPorts clamps_;
  ObstacleTrackers obstacles_;
  RobotTrackers robot_;
  CameraTopic camera_;
  Publishers publishers_;
  Services services_;
  Actions actions_;
  Inputs inputs_;
  LiveParameters liveParameters_;
  std::unique_ptr<Handles> handles_;  ///< if asked for
  std::unique_ptr<MasterWatch> watch_;
};

}  // namespace

int runNode(int argc, char** argv) {
  try {
    ros::init(argc, argv, "cloth");
    std::signal(SIGTERM, onTerminate);
    reportOutputErrors();
    ros::NodeHandle handle;
    ros::NodeHandle privateHandle("~");
    std::optional<LoadingWatch> loading(std::in_place);
    const NodeParameters parameters = readParameters(privateHandle);
    const Robot robot = loadRobot(handle, parameters);
    const Scene scene = loadNodeScene(parameters, robot);
    checkTrackedObstacles(parameters, scene);
    Node node(handle, privateHandle, parameters, scene, robot);
    ros::AsyncSpinner spinner(kCallbackThreads);
    spinner.start();
    loading.reset();
    awaitShutdown();
    {
      const ShutdownDeadline deadline(kStopWithin);
      node.stop();
    }
    ros::waitForShutdown();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "cloth_node: " << error.what() << std::endl;
    return kBadInput;
  }
}

}  // namespace cloth_sim
