#include "requests.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "cloth_sim/ros/conversions.h"
#include "scene/names.h"
#include "simulation_thread.h"

namespace cloth_sim {
namespace {

constexpr std::size_t kMaxNameLength = 100;
constexpr double kLeastFactor = 1e-3;  ///< of real time [-]
constexpr double kMostFactor = 1e3;
constexpr std::size_t kMaxPoints = 10000;  ///< of a stroke or path

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Zero means the default.
void takeIfGiven(double given, double& value) {
  if (given != 0.0) value = given;
}

bool allFinite(const std::vector<geometry_msgs::Point>& points) {
  return std::all_of(points.begin(), points.end(),
                     [](const auto& point) { return fromPoint(point).allFinite(); });
}

/// Empty if there are points, not too many, all finite.
std::string pointsDefect(const std::vector<geometry_msgs::Point>& points, const char* what) {
  if (points.empty()) return std::string(what) + " is empty";
  if (points.size() > kMaxPoints) {
    return std::string(what) + " has more than " + std::to_string(kMaxPoints) + " points";
  }
  return allFinite(points) ? "" : "a point is not finite";
}

/// Empty if what `message` says of the blade besides its points can be used.
std::string bladeDefect(const CutStroke& message) {
  if (!message.heels.empty()) {
    if (message.heels.size() != message.points.size()) {
      return "heels must be none or as many as points (got " +
             std::to_string(message.heels.size()) + " and " +
             std::to_string(message.points.size()) + ")";
    }
    return allFinite(message.heels) ? "" : "a heel is not finite";
  }
  const Vec3 direction = fromVector(message.direction);
  if (!direction.allFinite()) return "the blade's direction is not finite";
  if (direction.isZero(0.0)) return "the blade's direction is zero";
  if (!isNotNegative(message.reach)) return "reach must be a finite number >= 0";
  return "";
}

/// Empty if `message` has the form of a stroke; whether its blade gets anywhere is not looked at.
std::string strokeDefect(const CutStroke& message) {
  const std::string defect = pointsDefect(message.points, "the stroke");
  if (!defect.empty()) return defect;
  if (message.points.size() < 2) return "the stroke needs at least two points";
  if (!isNotNegative(message.half_width)) return "half_width must be a finite number >= 0";
  return bladeDefect(message);
}

std::string refinementDefect(const Refine::Request& message) {
  if (!isNotNegative(message.radius) || message.radius == 0.0) {
    return "radius must be a finite number > 0";
  }
  if (message.generations > kMostGenerations) {
    return "generations must be 0 ... " + std::to_string(kMostGenerations) + " (got " +
           std::to_string(message.generations) + ")";
  }
  if (!isNotNegative(message.min_edge)) return "min_edge must be a finite number >= 0";
  return pointsDefect(message.points, "the path");
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

}  // namespace

RequestChecker::RequestChecker(const Scene& scene, WorldTransform toWorld)
    : toWorld_(std::move(toWorld)) {
  for (const PhaseSpec& phase : scene.phases) phases_.push_back(phase.name);
}

Request RequestChecker::clampPose(const std::string& clamp,
                                  const geometry_msgs::PoseStamped& message) const {
  Pose pose{fromPoint(message.pose.position), fromQuaternion(message.pose.orientation)};
  const std::string defect = validationError(pose);
  if (!defect.empty()) return Refusal{defect};
  pose.orientation.normalize();
  try {
    return SetClampTarget{clamp, toWorld_(pose, message.header)};
  } catch (const std::runtime_error& error) {
    return Refusal{error.what()};
  }
}

Request RequestChecker::grasp(const std::string& clamp, bool grasp) const {
  return SetGrasp{clamp, grasp};
}

Request RequestChecker::gripWidth(const std::string& clamp, double width) const {
  if (!std::isfinite(width)) return Refusal{"the width is not finite"};
  return SetGapWidth{clamp, width};
}

std::vector<Request> RequestChecker::gripper(const std::string& clamp,
                                             const GripperCommand& command) const {
  const Request width = gripWidth(clamp, command.position);
  if (std::holds_alternative<Refusal>(width)) return {width};
  if (!isNotNegative(command.max_effort)) {
    return {Refusal{"max_effort must be a finite number >= 0"}};
  }
  if (command.max_effort == 0.0) return {width};
  return {SetGripForce{clamp, command.max_effort}, width};
}

Request RequestChecker::newClamp(const AddClamp::Request& message) const {
  ClampSpec spec;
  spec.name = message.name;
  const std::string defect = clampNameDefect(message.name);
  if (!defect.empty()) return Refusal{"name: " + defect};
  const Request pose = clampPose(message.name, message.pose);
  if (const auto* refusal = std::get_if<Refusal>(&pose)) return *refusal;
  spec.pose = std::get<SetClampTarget>(std::get<Command>(pose)).pose;
  takeIfGiven(message.plate_size[0], spec.plateSize.x());
  takeIfGiven(message.plate_size[1], spec.plateSize.y());
  takeIfGiven(message.gap_open, spec.gapOpen);
  takeIfGiven(message.gap_closed, spec.gapClosed);
  takeIfGiven(message.closing_speed, spec.closingSpeed);
  takeIfGiven(message.max_speed, spec.maxLinearSpeed);
  takeIfGiven(message.max_angular_speed, spec.maxAngularSpeed);
  takeIfGiven(message.max_acceleration, spec.maxLinearAcceleration);
  if (message.grip_force != 0.0) spec.gripForce = message.grip_force;
  return CreateClamp{spec};
}

Request RequestChecker::phase(const std::string& phase) const {
  if (!contains(phases_, phase)) return Refusal{unknownName("phase", phase, phases_)};
  return SetPhase{phase};
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
      return Refusal{"scope must be 0 (both), 1 (state) or 2 (time) (got " + std::to_string(scope) +
                     ")"};
  }
}

std::string RequestChecker::realTimeFactor(double factor) const {
  if (factor == 0.0 || (factor >= kLeastFactor && factor <= kMostFactor)) return "";
  return "the real-time factor must be 0.001 ... 1000, or 0 for as fast as it can (got " +
         std::to_string(factor) + ")";
}

std::string RequestChecker::steps(std::uint32_t count) const {
  if (count >= 1 && count <= static_cast<std::uint32_t>(SimulationThread::kMaxSteps)) return "";
  return "steps must be 1 ... " + std::to_string(SimulationThread::kMaxSteps) + " (got " +
         std::to_string(count) + ")";
}

Request RequestChecker::stroke(const CutStroke& message) const {
  std::string defect = strokeDefect(message);
  if (!defect.empty()) return Refusal{defect};
  try {
    const Stroke stroke = toStroke(message, toWorld_(Pose(), message.header));
    defect = validationError(stroke);
    if (!defect.empty()) return Refusal{defect};
    return CutAlong{stroke};
  } catch (const std::runtime_error& error) {
    return Refusal{error.what()};
  }
}

Request RequestChecker::drag(const DragRay& message) const {
  if (!message.held) return PullParticle{false, Ray()};
  Ray ray{fromPoint(message.origin), fromVector(message.direction)};
  const std::string defect = validationError(ray);
  if (!defect.empty()) return Refusal{defect};
  try {
    const Pose frame = toWorld_(Pose(), message.header);
    return PullParticle{true, {frame.toWorld(ray.origin), frame.orientation * ray.direction}};
  } catch (const std::runtime_error& error) {
    return Refusal{error.what()};
  }
}

Request RequestChecker::refinement(const Refine::Request& message) const {
  const std::string defect = refinementDefect(message);
  if (!defect.empty()) return Refusal{defect};
  Refinement refinement;
  refinement.radius = message.radius;
  if (message.generations > 0) refinement.generations = message.generations;
  refinement.minEdge = message.min_edge;
  try {
    return RefineMesh{{inWorld(message.points, toWorld_(Pose(), message.header)), refinement}};
  } catch (const std::runtime_error& error) {
    return Refusal{error.what()};
  }
}

std::string RequestChecker::stateName(const std::string& name) const {
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
