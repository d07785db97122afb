#include "handles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/ros/shading.h"
#include "submit.h"

namespace cloth_sim {
namespace {

using visualization_msgs::InteractiveMarker;
using visualization_msgs::InteractiveMarkerControl;
using visualization_msgs::Marker;

constexpr double kPeriod = 1.0 / 20.0;  ///< between updates [s]
constexpr double kClampScale = 3.0;     ///< of a clamp's handle, over its plates' shorter side [-]
constexpr double kLeastScale = 0.05;    ///< of them [m]
constexpr double kMostScale = 0.22;     ///< of them [m]
constexpr double kMargin = 0.12;        ///< of an obstacle's arrows beyond it [m]
constexpr double kGrip = 1.15;          ///< size of the shape to click at, over the real one [-]
constexpr double kObstacleSpeed = 0.5;  ///< [m/s]
constexpr double kStill = 1e-4;         ///< smaller differences of poses are ignored [m], [rad]
const std::string kTopic = "handles";
const std::string kClampPrefix = "clamp/";
const std::string kObstaclePrefix = "obstacle/";

/// Returns the part of `marker` after `prefix`; empty if it does not begin with the prefix.
std::string after(const std::string& prefix, const std::string& marker) {
  return marker.compare(0, prefix.size(), prefix) == 0 ? marker.substr(prefix.size()) : "";
}

/// Adds arrows or rings along the three axes of the marker.
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

/// Adds a translucent shape to click at.
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
  // The shorter side: around long plates, rings of their length would hide the cloth.
  marker.scale = static_cast<float>(
      std::clamp(kClampScale * clamp.plateSize.minCoeff(), kLeastScale, kMostScale));
  addShape(Marker::CUBE, Vec3(clamp.plateSize.x(), clamp.plateSize.y(), clamp.gap),
           InteractiveMarkerControl::MENU, marker);
  addAxes(InteractiveMarkerControl::MOVE_AXIS, "move", marker);
  addAxes(InteractiveMarkerControl::ROTATE_AXIS, "turn", marker);
  return marker;
}

InteractiveMarker obstacleHandle(const Obstacle& obstacle, const std::string& world) {
  InteractiveMarker marker = handle(kObstaclePrefix + obstacle.name, obstacle.pose, world);
  marker.scale = static_cast<float>(handleRadius(obstacle.shape).value_or(0.0) + kMargin);
  addAxes(InteractiveMarkerControl::MOVE_AXIS, "move", marker);
  return marker;
}

bool hasHandle(const Obstacle& obstacle) { return handleRadius(obstacle.shape).has_value(); }

Handles::Handles(const ros::NodeHandle& privateNode, const std::string& world,
                 const RequestChecker& checker, SimulationThread& simulation)
    : checker_(checker),
      simulation_(simulation),
      world_(world),
      server_(privateNode.resolveName("handles")) {
  menu_.insert("Grasp", [this](const auto& feedback) { onGrasp(feedback->marker_name, true); });
  menu_.insert("Release", [this](const auto& feedback) { onGrasp(feedback->marker_name, false); });
  const Observation observation = simulation.observe();
  updateClampHandles(*observation.snapshot);
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

/// Adds handles for new clamps and removes those of clamps that are gone.
void Handles::updateClampHandles(const Snapshot& now) {
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
    submit(kTopic, checker_.clampPose(clamp, pose), simulation_);
  } else {
    sendObstacle(after(kObstaclePrefix, feedback.marker_name), fromPoint(feedback.pose.position));
  }
}

void Handles::onGrasp(const std::string& marker, bool grasp) {
  submit(kTopic, checker_.grasp(after(kClampPrefix, marker), grasp), simulation_);
}

void Handles::sendObstacle(const std::string& obstacle, const Vec3& goal) {
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

/// Moves the handles. The server calls `onFeedback` with its own mutex locked, so it must not be
/// called with ours locked.
void Handles::refresh() {
  const std::shared_ptr<const Snapshot> now = simulation_.observe().snapshot;
  updateClampHandles(*now);
  for (const auto& [marker, pose] : moved(*now)) server_.setPose(marker, toPoseMessage(pose));
  server_.applyChanges();
}

/// Moves obstacles on towards their handles, and returns the poses of handles that are to be moved.
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

/// Moves an obstacle towards its handle, as far as it gets by `time` [s].
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
  if (reach > 0.0) {
    submit(kTopic, MoveObstacle{obstacle, guided.pose, Vec3::Zero()}, simulation_);
  }
}

bool Handles::shallShow(const std::string& marker, const Pose& pose) {
  if (marker == held_) return false;
  const auto [shown, isNew] = shown_.try_emplace(marker, pose);
  if (!isNew && !differ(shown->second, pose)) return false;
  shown->second = pose;
  return true;
}

}  // namespace cloth_sim
