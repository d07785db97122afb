#include "cloth_sim/ros/requests.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/ros/simulation_thread.h"
#include "cloth_sim/scene/names.h"

namespace cloth_sim {
namespace {

constexpr double kUnitTolerance = 1e-3;  ///< of a quaternion's norm: float32 senders round
constexpr std::size_t kMaxNameLength = 100;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Empty if `pose` is one.
std::string poseDefect(const Pose& pose) {
  if (!pose.position.allFinite()) return "the position is not finite";
  if (!pose.orientation.coeffs().allFinite()) return "the orientation is not finite";
  const double norm = pose.orientation.norm();
  if (std::abs(norm - 1.0) > kUnitTolerance) {
    return "the orientation is not a unit quaternion (norm " + std::to_string(norm) + ")";
  }
  return "";
}

}  // namespace

RequestChecker::RequestChecker(const Scene& scene, WorldTransform toWorld)
    : toWorld_(std::move(toWorld)) {
  for (const ClampSpec& clamp : scene.clamps) clamps_.push_back(clamp.name);
  for (const PhaseSpec& phase : scene.phases) phases_.push_back(phase.name);
}

Request RequestChecker::clampPose(const std::string& clamp,
                                  const geometry_msgs::PoseStamped& message) const {
  if (!contains(clamps_, clamp)) return Refusal{unknownName("clamp", clamp, clamps_)};
  Pose pose{fromPoint(message.pose.position), fromQuaternion(message.pose.orientation)};
  const std::string defect = poseDefect(pose);
  if (!defect.empty()) return Refusal{defect};
  pose.orientation.normalize();
  try {
    return SetClampTarget{clamp, toWorld_(pose, message.header)};
  } catch (const std::runtime_error& error) {
    return Refusal{error.what()};
  }
}

Request RequestChecker::grasp(const std::string& clamp, bool grasp) const {
  if (!contains(clamps_, clamp)) return Refusal{unknownName("clamp", clamp, clamps_)};
  return SetGrasp{clamp, grasp};
}

Request RequestChecker::phase(const std::string& phase) const {
  if (!contains(phases_, phase)) return Refusal{unknownName("phase", phase, phases_)};
  return SetPhase{phase};
}

std::string RequestChecker::steps(std::uint32_t count) const {
  if (count >= 1 && count <= static_cast<std::uint32_t>(SimulationThread::kMaxSteps)) return "";
  return "steps must be 1 ... " + std::to_string(SimulationThread::kMaxSteps) + " (got " +
         std::to_string(count) + ")";
}

/// Empty if all points are finite and their frame is known.
std::string RequestChecker::points(const std_msgs::Header& header,
                                   const std::vector<geometry_msgs::Point>& points) const {
  for (const geometry_msgs::Point& point : points) {
    if (!fromPoint(point).allFinite()) return "a point is not finite";
  }
  try {
    toWorld_(Pose(), header);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

std::string RequestChecker::stroke(const CutStroke& stroke) const {
  if (stroke.points.empty()) return "the stroke is empty";
  const Vec3 first = fromPoint(stroke.points.front());
  const bool moves =
      std::any_of(stroke.points.begin(), stroke.points.end(),
                  [&](const geometry_msgs::Point& point) { return fromPoint(point) != first; });
  if (!moves) return "the stroke needs at least two different points";
  const Vec3 direction(stroke.direction.x, stroke.direction.y, stroke.direction.z);
  if (!direction.allFinite()) return "the blade's direction is not finite";
  if (direction.isZero(0.0)) return "the blade's direction is zero";
  if (!std::isfinite(stroke.half_width) || stroke.half_width < 0.0) {
    return "half_width must be a finite number >= 0";
  }
  return points(stroke.header, stroke.points);
}

std::string RequestChecker::refinement(const Refine::Request& request) const {
  if (request.points.empty()) return "the path is empty";
  if (!std::isfinite(request.radius) || request.radius <= 0.0) {
    return "radius must be a finite number > 0";
  }
  if (!std::isfinite(request.edge_length) || request.edge_length <= 0.0) {
    return "edge_length must be a finite number > 0";
  }
  return points(request.header, request.points);
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
