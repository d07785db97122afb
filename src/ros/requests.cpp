#include "requests.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <utility>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/validation.h"
#include "scene/names.h"
#include "simulation_thread.h"

namespace cloth_sim {
namespace {

constexpr std::size_t kMaxNameLength = 100;
constexpr double kMinFactor = 1e-3;  ///< of real time [-]
constexpr double kMaxRequestFactor = 1e3;
constexpr std::size_t kMaxPoints = 10000;  ///< of a stroke or path

/// Overwrites a default, unless the message leaves the field at zero.
void takeIfGiven(double given, double& value) {
  if (given != 0.0) value = given;
}

/// Returns what is wrong with the size of a list of points; empty if nothing is.
std::string sizeError(const std::vector<geometry_msgs::Point>& points, const char* name) {
  if (points.size() <= kMaxPoints) return "";
  return std::string(name) + ": expected at most " + std::to_string(kMaxPoints) + " points (got " +
         std::to_string(points.size()) + ")";
}

/// Returns what is wrong with the fields that describe the blade; empty if nothing is.
std::string bladeError(const CutStroke& message) {
  if (!message.heels.empty()) {
    if (message.heels.size() == message.points.size()) return "";
    return "heels: expected none, or as many as points (got " +
           std::to_string(message.heels.size()) + " and " + std::to_string(message.points.size()) +
           ")";
  }
  const Vec3 direction = fromVector(message.direction);
  if (!direction.allFinite()) return "direction: expected three finite numbers";
  if (direction.isZero(0.0)) return "direction: expected a vector that is not zero";
  if (!isNotNegative(message.reach)) return "reach: expected a finite number >= 0";
  return "";
}

/// \param frame  that `points` are in, as a pose in the world.
std::vector<Vec3> inWorld(const std::vector<geometry_msgs::Point>& points, const Pose& frame) {
  std::vector<Vec3> result;
  result.reserve(points.size());
  for (const geometry_msgs::Point& point : points) {
    result.push_back(frame.toWorld(fromPoint(point)));
  }
  return result;
}

Stroke toStroke(const CutStroke& message, const Pose& frame) {
  const std::vector<Vec3> tips = inWorld(message.points, frame);
  Stroke stroke;
  if (message.heels.empty()) {
    const Vec3 direction = frame.orientation * fromVector(message.direction);
    stroke = strokeAlong(tips, direction, message.reach > 0.0 ? message.reach : kDefaultReach);
  } else {
    const std::vector<Vec3> heels = inWorld(message.heels, frame);
    for (std::size_t i = 0; i < tips.size(); ++i) stroke.poses.push_back({heels[i], tips[i]});
  }
  stroke.firstLayerOnly = message.first_layer_only != 0;
  stroke.halfWidth = message.half_width;
  return stroke;
}

ClampSpec toClampSpec(const AddClamp::Request& message, const Pose& pose) {
  ClampSpec spec;
  spec.name = message.name;
  spec.pose = pose;
  takeIfGiven(message.plate_size[0], spec.plateSize.x());
  takeIfGiven(message.plate_size[1], spec.plateSize.y());
  takeIfGiven(message.gap_open, spec.gapOpen);
  takeIfGiven(message.gap_closed, spec.gapClosed);
  takeIfGiven(message.closing_speed, spec.closingSpeed);
  takeIfGiven(message.max_speed, spec.maxLinearSpeed);
  takeIfGiven(message.max_angular_speed, spec.maxAngularSpeed);
  takeIfGiven(message.max_acceleration, spec.maxLinearAcceleration);
  if (message.grip_force != 0.0) spec.gripForce = message.grip_force;
  return spec;
}

/// Returns `given`, or the default where the message leaves the field at zero.
double orDefault(double given, double standard) { return given == 0.0 ? standard : given; }

/// Returns what is wrong with the numbers of poses and times; empty if nothing is.
std::string countError(const MoveClampGoal& goal) {
  if (goal.poses.size() > kMaxPoints) {
    return "poses: expected at most " + std::to_string(kMaxPoints) + " (got " +
           std::to_string(goal.poses.size()) + ")";
  }
  if (goal.times_from_start.empty() || goal.times_from_start.size() == goal.poses.size()) return "";
  return "times_from_start: expected none, or as many as poses (got " +
         std::to_string(goal.times_from_start.size()) + " and " +
         std::to_string(goal.poses.size()) + ")";
}

/// Returns what keeps a trajectory from being that of one body; empty if nothing does.
std::string bodyError(const trajectory_msgs::MultiDOFJointTrajectory& message) {
  if (message.joint_names.size() > 1) {
    return "joint_names: expected one at most (got " + std::to_string(message.joint_names.size()) +
           ")";
  }
  for (std::size_t k = 0; k < message.points.size(); ++k) {
    const std::size_t count = message.points[k].transforms.size();
    if (count == 1) continue;
    return "points[" + std::to_string(k) + "].transforms: expected one (got " +
           std::to_string(count) + ")";
  }
  return "";
}

geometry_msgs::Pose poseOf(const geometry_msgs::Transform& transform) {
  geometry_msgs::Pose pose;
  pose.position.x = transform.translation.x;
  pose.position.y = transform.translation.y;
  pose.position.z = transform.translation.z;
  pose.orientation = transform.rotation;
  return pose;
}

/// Calls `make`, which looks up a frame, and refuses the request if the frame is unknown.
template <typename Make>
Request inKnownFrame(const Make& make) {
  try {
    return Command{make()};
  } catch (const std::runtime_error& error) {
    return Refusal{error.what()};
  }
}

}  // namespace

RequestChecker::RequestChecker(const Scene& scene, WorldTransform toWorld)
    : toWorld_(std::move(toWorld)) {
  for (const PhaseSpec& phase : scene.phases) phases_.push_back(phase.name);
}

/// Checks the pose before the transform, after which every quaternion is of norm 1.
Request RequestChecker::clampPose(const std::string& clamp,
                                  const geometry_msgs::PoseStamped& message) const {
  Pose pose{fromPoint(message.pose.position), fromQuaternion(message.pose.orientation)};
  const std::string error = validationError(pose);
  if (!error.empty()) return Refusal{error};
  pose.orientation.normalize();
  return inKnownFrame([&] { return SetClampTarget{clamp, toWorld_(pose, message.header)}; });
}

Request RequestChecker::grasp(const std::string& clamp, bool grasp) const {
  return SetGrasp{clamp, grasp};
}

Request RequestChecker::gripWidth(const std::string& clamp, double width) const {
  return SetGapWidth{clamp, width};
}

std::vector<Request> RequestChecker::gripper(const std::string& clamp,
                                             const GripperCommand& command) const {
  std::vector<Request> requests;
  if (command.max_effort != 0.0) requests.push_back(SetGripForce{clamp, command.max_effort});
  requests.push_back(gripWidth(clamp, command.position));
  // Both or none.
  for (const Request& request : requests) {
    const std::string error = validationError(std::get<Command>(request));
    if (!error.empty()) return {Refusal{error}};
  }
  return requests;
}

MoveRequest RequestChecker::move(const MoveClampGoal& goal) const {
  std::string error = countError(goal);
  if (!error.empty()) return Refusal{error};
  MovePlan plan;
  plan.timed = !goal.times_from_start.empty();
  plan.speed = goal.speed;
  plan.positionTolerance = orDefault(goal.position_tolerance, plan.positionTolerance);
  plan.orientationTolerance = orDefault(goal.orientation_tolerance, plan.orientationTolerance);
  if (goal.time_limit != 0.0) plan.timeLimit = goal.time_limit;
  for (std::size_t k = 0; k < goal.poses.size(); ++k) {
    const Request pose = clampPose("", goal.poses[k]);
    if (const auto* refusal = std::get_if<Refusal>(&pose)) {
      return Refusal{"poses[" + std::to_string(k) + "]: " + refusal->message};
    }
    const double time = plan.timed ? goal.times_from_start[k].toSec() : 0.0;
    plan.waypoints.push_back({std::get<SetClampTarget>(std::get<Command>(pose)).pose, time});
  }
  error = validationError(plan);
  if (!error.empty()) return Refusal{error};
  return plan;
}

/// Looks up the latest transform of the frame, because the stamp is that of the start.
MoveRequest RequestChecker::trajectory(
    const trajectory_msgs::MultiDOFJointTrajectory& message) const {
  const std::string error = bodyError(message);
  if (!error.empty()) return Refusal{error};
  MoveClampGoal goal;
  for (const auto& point : message.points) {
    geometry_msgs::PoseStamped pose;
    pose.header.frame_id = message.header.frame_id;
    pose.pose = poseOf(point.transforms.front());
    goal.poses.push_back(pose);
    goal.times_from_start.push_back(point.time_from_start);
  }
  return move(goal);
}

Request RequestChecker::newClamp(const AddClamp::Request& message) const {
  const std::string error = clampNameError(message.name);
  if (!error.empty()) return Refusal{"name: " + error};
  const Request pose = clampPose(message.name, message.pose);
  if (const auto* refusal = std::get_if<Refusal>(&pose)) return *refusal;
  return CreateClamp{toClampSpec(message, std::get<SetClampTarget>(std::get<Command>(pose)).pose)};
}

Request RequestChecker::resolution(std::uint32_t columns) const {
  // Numbers beyond those of the command are out of range, too.
  constexpr std::uint32_t kMost = std::numeric_limits<std::int32_t>::max();
  return SetResolution{static_cast<std::int32_t>(std::min(columns, kMost))};
}

Request RequestChecker::reset(std::uint8_t scope) const {
  switch (scope) {
    case ResetScene::Request::BOTH:
      return Reset{ResetScope::kBoth};
    case ResetScene::Request::STATE:
      return Reset{ResetScope::kState};
    case ResetScene::Request::TIME:
      return Reset{ResetScope::kTime};
    default:
      return Refusal{"scope: expected 0 (both), 1 (state) or 2 (time) (got " +
                     std::to_string(scope) + ")"};
  }
}

Request RequestChecker::stroke(const CutStroke& message) const {
  std::string error = sizeError(message.points, "points");
  if (error.empty()) error = bladeError(message);
  if (!error.empty()) return Refusal{error};
  return inKnownFrame([&] { return CutAlong{toStroke(message, frameOf(message.header))}; });
}

Request RequestChecker::drag(const DragRay& message) const {
  if (!message.held) return PullParticle{false, Ray()};
  return inKnownFrame([&] {
    const Pose frame = frameOf(message.header);
    return PullParticle{true,
                        {frame.toWorld(fromPoint(message.origin)),
                         frame.orientation * fromVector(message.direction)}};
  });
}

Request RequestChecker::refinement(const Refine::Request& message) const {
  const std::string error = sizeError(message.points, "points");
  if (!error.empty()) return Refusal{error};
  Refinement refinement;
  refinement.radius = message.radius;
  if (message.generations > 0) refinement.generations = message.generations;
  refinement.minEdge = message.min_edge;
  return inKnownFrame([&] {
    return RefineMesh{{inWorld(message.points, frameOf(message.header)), refinement}};
  });
}

std::string RequestChecker::phaseError(const std::string& phase) const {
  const bool known = std::find(phases_.begin(), phases_.end(), phase) != phases_.end();
  return known ? "" : unknownName("phase", phase, phases_);
}

std::string realTimeFactorError(double factor) {
  if (factor == 0.0 || (factor >= kMinFactor && factor <= kMaxRequestFactor)) return "";
  return "real-time factor: expected 0.001 ... 1000, or 0 for as fast as possible (got " +
         std::to_string(factor) + ")";
}

std::string stepCountError(std::uint32_t count) {
  if (count >= 1 && count <= static_cast<std::uint32_t>(SimulationThread::kMaxSteps)) return "";
  return "steps: expected 1 ... " + std::to_string(SimulationThread::kMaxSteps) + " (got " +
         std::to_string(count) + ")";
}

std::string stateNameError(const std::string& name) {
  const auto allowed = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  };
  if (name.empty()) return "the name is empty";
  if (name.size() > kMaxNameLength) return "the name is longer than 100 characters";
  if (name.front() == '.' || !std::all_of(name.begin(), name.end(), allowed)) {
    return "the name may have letters, digits, '_', '-' and '.', and must not begin with '.'";
  }
  return "";
}

}  // namespace cloth_sim
