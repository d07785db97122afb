#include "robot_trackers.h"

#include <ros/console.h>

#include <cmath>

#include "submit.h"

namespace cloth_sim {
namespace {

/// Time for which tf may lack a link at the start, until a warning names it [s].
constexpr double kFirstSight = 5.0;
/// Changes below these are not told, so that other commands to the clamp last.
constexpr double kLeastChange = 1e-5;       ///< of a gap or place [m]
constexpr double kLeastTurn = 1e-4;         ///< [rad]
constexpr double kLeastForceChange = 0.01;  ///< of the grip force, as a share of it
constexpr double kWarningPeriod = 5.0;      ///< [s]

bool areNear(const Pose& a, const Pose& b) {
  return (a.position - b.position).norm() < kLeastChange &&
         a.orientation.angularDistance(b.orientation) < kLeastTurn;
}

/// Tells whether a number differs from the last one by more than `least`, and keeps it then.
bool isNews(std::optional<double>& last, double now, double least) {
  if (last && std::abs(*last - now) < least) return false;
  last = now;
  return true;
}

std::vector<std::string> motorNames(const std::vector<RobotGripper>& grippers) {
  std::vector<std::string> names;
  for (const RobotGripper& it : grippers) {
    if (it.motor) names.push_back(it.motor->name);
  }
  return names;
}

PoseSource linkSource(const std::string& frame) {
  PoseSource source;
  source.kind = PoseSource::Kind::kFrame;
  source.name = frame;
  source.patience = kFirstSight;
  return source;
}

}  // namespace

RobotTrackers::RobotTrackers(ros::NodeHandle& node, const Robot& robot, double rate,
                             const WorldFrame& world, SimulationThread& simulation)
    : rate_(rate), world_(world), simulation_(simulation) {
  std::map<std::string, Obstacles> ofLink;
  for (const RobotObstacle& it : robot.obstacles) ofLink[it.link].push_back(it);
  for (const auto& [link, obstacles] : ofLink) trackLink(node, link, obstacles);
  const std::vector<std::string> motors = motorNames(robot.grippers);
  if (!motors.empty()) efforts_ = JointEfforts::subscribe(motors);
  for (const RobotGripper& gripper : robot.grippers) trackGripper(node, gripper);
}

void RobotTrackers::trackLink(ros::NodeHandle& node, const std::string& link,
                              const Obstacles& obstacles) {
  const PoseTracker::Sink sink = [this, obstacles](const MovingPose& target) {
    place(obstacles, target);
  };
  trackers_.push_back(
      PoseTracker::track(node, "robot link " + link, linkSource(link), world_, rate_, sink));
}

void RobotTrackers::trackGripper(ros::NodeHandle& node, const RobotGripper& gripper) {
  const PoseTracker::Sink sink = [this, gripper](const MovingPose& target) {
    moveClamp(gripper, target);
  };
  PoseSource source = linkSource(gripper.base);
  source.repeatsStatic = true;  // fingers move on a base that stands, too
  trackers_.push_back(
      PoseTracker::track(node, "clamp " + gripper.clamp, source, world_, rate_, sink));
}

void RobotTrackers::place(const Obstacles& obstacles, const MovingPose& link) {
  for (const RobotObstacle& it : obstacles) {
    submit("robot/" + it.name, Command{GuideObstacle{it.name, carried(link, it.part.place)}},
           simulation_);
  }
}

void RobotTrackers::moveClamp(const RobotGripper& gripper, const MovingPose& base) {
  std::array<Pose, 2> poses;
  try {
    for (std::size_t k = 0; k < poses.size(); ++k) {
      poses[k] = world_.latestIn(gripper.base, gripper.plates[k].frame);
    }
  } catch (const std::runtime_error& error) {
    ROS_WARN_STREAM_THROTTLE(kWarningPeriod, "clamp " << gripper.clamp << ": " << error.what());
    return;
  }
  const std::optional<PlatePlacement> between = placeBetween(gripper.plates, poses);
  if (!between) return;
  const MovingPose target = carried(base, between->pose);
  const std::lock_guard<std::mutex> lock(mutex_);
  Told& told = told_[gripper.clamp];
  const std::string topic = "robot/" + gripper.clamp;
  if (target.horizon > 0.0 || !told.pose || !areNear(*told.pose, target.pose)) {
    told.pose = target.pose;
    submit(topic, Command{GuideClamp{gripper.clamp, target}}, simulation_);
  }
  const std::optional<double> force = forceOf(gripper, between->middles);
  if (force && isNews(told.force, *force, kLeastForceChange * *force)) {
    submit(topic, Command{SetGripForce{gripper.clamp, force}}, simulation_);
  }
  if (isNews(told.gap, between->gap, kLeastChange)) {
    submit(topic, Command{SetGapWidth{gripper.clamp, between->gap}}, simulation_);
  }
}

/// The grip force of a gripper by the effort of its motor [N]; nothing as long as that is unknown.
std::optional<double> RobotTrackers::forceOf(const RobotGripper& gripper,
                                             const std::array<Vec3, 2>& middles) const {
  if (!gripper.motor) return std::nullopt;
  const std::optional<double> effort = efforts_->of(gripper.motor->name);
  if (!effort) return std::nullopt;
  try {
    const Pose joint = world_.latestIn(gripper.base, gripper.motor->joint.link);
    return gripForce(*gripper.motor, *effort, joint, middles);
  } catch (const std::runtime_error& error) {
    ROS_WARN_STREAM_THROTTLE(kWarningPeriod, "clamp " << gripper.clamp << ": " << error.what());
    return std::nullopt;
  }
}

void RobotTrackers::repeat() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    told_.clear();
  }
  for (const auto& tracker : trackers_) tracker->repeat();
}

std::vector<TrackingStatus> RobotTrackers::statuses() const {
  std::vector<TrackingStatus> result;
  for (const auto& tracker : trackers_) result.push_back(tracker->status());
  return result;
}

}  // namespace cloth_sim
