#include "handles.h"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/ros/shading.h"

namespace cloth_sim {
namespace {

using visualization_msgs::InteractiveMarker;
using visualization_msgs::InteractiveMarkerControl;
using visualization_msgs::Marker;

constexpr double kPeriod = 1.0 / 20.0;  ///< of following [s]
constexpr double kClampScale = 0.22;    ///< of a clamp's arrows and rings [m]
constexpr double kMargin = 0.12;        ///< of an obstacle's arrows beyond it [m]
constexpr double kGrip = 1.15;          ///< what is clicked, times what it stands for [-]
constexpr double kObstacleSpeed = 0.5;  ///< [m/s]
constexpr double kStill = 1e-4;         ///< less than this is no motion [m], [-]
const std::string kClampPrefix = "clamp/";
const std::string kObstaclePrefix = "obstacle/";

/// The part of `marker` after `prefix`; empty if it does not begin with it.
std::string after(const std::string& prefix, const std::string& marker) {
  return marker.compare(0, prefix.size(), prefix) == 0 ? marker.substr(prefix.size()) : "";
}

/// Arrows, or rings, along the axes of the marker.
void addAxes(std::uint8_t mode, const std::string& what, InteractiveMarker& marker) {
  for (int axis = 0; axis < 3; ++axis) {
    InteractiveMarkerControl control;
    control.name = what + "_" + "xyz"[axis];
    control.interaction_mode = mode;
    const Vec3 along = Vec3::Unit(axis);
    control.orientation = toQuaternion(Quat::FromTwoVectors(Vec3::UnitX(), along));
    marker.controls.push_back(control);
  }
}

/// A translucent shape to click at.
void addShape(int type, const Vec3& size, std::uint8_t mode, InteractiveMarker& marker) {
  Marker shape;
  shape.type = type;
  shape.pose.orientation.w = 1.0;
  shape.scale = toVector(kGrip * size);
  shape.color = makeColour(0.35f, 0.65f, 1.0f, 0.25f);
  InteractiveMarkerControl control;
  control.name = "shape";
  control.interaction_mode = mode;
  control.always_visible = 1;
  control.markers.push_back(shape);
  marker.controls.push_back(control);
}

InteractiveMarker handle(const std::string& name, const Pose& pose, const std::string& world) {
  InteractiveMarker marker;
  marker.header.frame_id = world;
  marker.name = name;
  marker.pose = toPoseMessage(pose);
  return marker;
}

bool differ(const Pose& a, const Pose& b) {
  return (a.position - b.position).norm() > kStill ||
         a.orientation.angularDistance(b.orientation) > kStill;
}

}  // namespace

InteractiveMarker clampHandle(const ClampSnapshot& clamp, const std::string& world) {
  InteractiveMarker marker = handle(kClampPrefix + clamp.name, clamp.pose, world);
  marker.description = clamp.name;
  marker.scale = static_cast<float>(kClampScale);
  addShape(Marker::CUBE, Vec3(clamp.plateSize.x(), clamp.plateSize.y(), clamp.gap),
           InteractiveMarkerControl::MENU, marker);
  addAxes(InteractiveMarkerControl::MOVE_AXIS, "move", marker);
  addAxes(InteractiveMarkerControl::ROTATE_AXIS, "turn", marker);
  return marker;
}

InteractiveMarker obstacleHandle(const Obstacle& obstacle, const std::string& world) {
  InteractiveMarker marker = handle(kObstaclePrefix + obstacle.name, obstacle.pose, world);
  const auto* sphere = std::get_if<SphereShape>(&obstacle.shape);
  const auto* box = std::get_if<BoxShape>(&obstacle.shape);
  const double half = sphere != nullptr ? sphere->radius : 0.5 * box->size.minCoeff();
  marker.scale = static_cast<float>(half + kMargin);
  addAxes(InteractiveMarkerControl::MOVE_AXIS, "move", marker);
  return marker;
}

bool hasHandle(const Obstacle& obstacle) {
  return std::holds_alternative<SphereShape>(obstacle.shape) ||
         std::holds_alternative<BoxShape>(obstacle.shape);
}

Handles::Handles(const ros::NodeHandle& privateNode, const std::string& world,
                 const RequestChecker& checker, SimulationThread& simulation)
    : checker_(checker),
      simulation_(simulation),
      world_(world),
      server_(privateNode.resolveName("handles")) {
  menu_.insert("Grasp", [this](const auto& feedback) { onGrasp(feedback->marker_name, true); });
  menu_.insert("Release", [this](const auto& feedback) { onGrasp(feedback->marker_name, false); });
  const Observation observation = simulation.observe();
  followClamps(*observation.snapshot);
  for (const Obstacle& obstacle : observation.snapshot->obstacles) {
    if (hasHandle(obstacle)) add(obstacleHandle(obstacle, world));
  }
  server_.applyChanges();
  timer_ = ros::NodeHandle(privateNode)
               .createSteadyTimer(ros::WallDuration(kPeriod),
                                  [this](const ros::SteadyTimerEvent&) { refresh(); });
}

void Handles::add(const InteractiveMarker& marker) {
  server_.insert(marker, [this](const auto& feedback) { onFeedback(*feedback); });
}

/// Clamps come and go while the node runs.
void Handles::followClamps(const Snapshot& now) {
  std::set<std::string> gone = std::exchange(clamps_, {});
  for (const ClampSnapshot& clamp : now.clamps) {
    clamps_.insert(clamp.name);
    if (gone.erase(clamp.name) != 0) continue;
    add(clampHandle(clamp, world_));
    menu_.apply(server_, kClampPrefix + clamp.name);
  }
  for (const std::string& name : gone) {
    server_.erase(kClampPrefix + name);
    const std::lock_guard<std::mutex> lock(mutex_);
    shown_.erase(kClampPrefix + name);
  }
}

void Handles::onFeedback(const Feedback& feedback) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (feedback.event_type == Feedback::MOUSE_DOWN) held_ = feedback.marker_name;
  if (feedback.event_type == Feedback::MOUSE_UP) held_.clear();
  if (feedback.event_type != Feedback::POSE_UPDATE) return;
  shown_[feedback.marker_name] = {fromPoint(feedback.pose.position),
                                  fromQuaternion(feedback.pose.orientation)};
  const std::string clamp = after(kClampPrefix, feedback.marker_name);
  if (!clamp.empty()) {
    geometry_msgs::PoseStamped pose;
    pose.header.frame_id = feedback.header.frame_id;
    pose.pose = feedback.pose;
    submit(checker_.clampPose(clamp, pose));
  } else {
    guide(after(kObstaclePrefix, feedback.marker_name), fromPoint(feedback.pose.position));
  }
}

void Handles::onGrasp(const std::string& marker, bool grasp) {
  submit(checker_.grasp(after(kClampPrefix, marker), grasp));
}

void Handles::guide(const std::string& obstacle, const Vec3& goal) {
  if (!goal.allFinite()) return;
  const std::shared_ptr<const Snapshot> now = simulation_.observe().snapshot;
  const auto found = std::find_if(now->obstacles.begin(), now->obstacles.end(),
                                  [&](const Obstacle& o) { return o.name == obstacle; });
  if (found == now->obstacles.end()) return;
  Guided& guided = guided_[obstacle];
  guided.goal = goal;
  if (guided.underWay) return;
  guided.pose = found->pose;
  guided.time = now->time;
  guided.underWay = true;
}

/// The server calls `onFeedback` with its own mutex locked: so it is not called with ours locked.
void Handles::refresh() {
  const std::shared_ptr<const Snapshot> now = simulation_.observe().snapshot;
  followClamps(*now);
  for (const auto& [marker, pose] : moved(*now)) server_.setPose(marker, toPoseMessage(pose));
  server_.applyChanges();
}

/// Sends obstacles on their way, and says which handles are not where they should be.
std::map<std::string, Pose> Handles::moved(const Snapshot& now) {
  std::map<std::string, Pose> poses;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto& [obstacle, guided] : guided_) {
    if (guided.underWay) advance(obstacle, guided, now.time);
  }
  for (const ClampSnapshot& clamp : now.clamps) {
    const std::string marker = kClampPrefix + clamp.name;
    if (shallShow(marker, clamp.pose)) poses[marker] = clamp.pose;
  }
  for (const Obstacle& obstacle : now.obstacles) {
    const std::string marker = kObstaclePrefix + obstacle.name;
    const auto guided = guided_.find(obstacle.name);
    if (!hasHandle(obstacle) || (guided != guided_.end() && guided->second.underWay)) continue;
    if (shallShow(marker, obstacle.pose)) poses[marker] = obstacle.pose;
  }
  return poses;
}

/// One stretch of its way, as far as simulated time has gone.
void Handles::advance(const std::string& obstacle, Guided& guided, double time) {
  const double reach = kObstacleSpeed * std::max(0.0, time - guided.time);
  guided.time = time;
  const Vec3 left = guided.goal - guided.pose.position;
  const double distance = left.norm();
  if (distance > reach) {
    guided.pose.position += left * (reach / distance);
  } else {
    guided.pose.position = guided.goal;
    guided.underWay = false;
  }
  if (reach > 0.0) submit(Command{MoveObstacle{obstacle, guided.pose, Vec3::Zero()}});
}

bool Handles::shallShow(const std::string& marker, const Pose& pose) {
  if (marker == held_) return false;
  const auto [shown, isNew] = shown_.try_emplace(marker, pose);
  if (!isNew && !differ(shown->second, pose)) return false;
  shown->second = pose;
  return true;
}

void Handles::submit(const Request& request) {
  const auto warn = [](const std::string& why) {
    ROS_WARN_STREAM_THROTTLE(0.5, "~handles: refused: " << why);
  };
  if (const auto* refusal = std::get_if<Refusal>(&request)) {
    warn(refusal->message);
    return;
  }
  simulation_.post(std::get<Command>(request), [warn](const CommandResult& result) {
    if (!result.success) warn(result.message);
  });
}

}  // namespace cloth_sim
