#include "robot_trackers.h"

#include <ros/console.h>

#include <cmath>

#include "submit.h"

namespace cloth_sim {
namespace {

/// Time for which tf may lack a link at the start, until a warning names it [s].
constexpr double kFirstSight = 5.0;
/// Changes of a gap below this are not told, so that other commands to the plates last [m].
constexpr double kLeastChange = 1e-5;
constexpr double kWarningPeriod = 5.0;  ///< [s]

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
  trackers_.push_back(PoseTracker::track(node, "clamp " + gripper.clamp, linkSource(gripper.base),
                                         world_, rate_, sink));
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
  const std::string topic = "robot/" + gripper.clamp;
  submit(topic, Command{GuideClamp{gripper.clamp, carried(base, between->pose)}}, simulation_);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto told = gaps_.find(gripper.clamp);
    if (told != gaps_.end() && std::abs(told->second - between->gap) < kLeastChange) return;
    gaps_[gripper.clamp] = between->gap;
  }
  submit(topic, Command{SetGapWidth{gripper.clamp, between->gap}}, simulation_);
}

void RobotTrackers::repeat() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    gaps_.clear();
  }
  for (const auto& tracker : trackers_) tracker->repeat();
}

std::vector<TrackingStatus> RobotTrackers::statuses() const {
  std::vector<TrackingStatus> result;
  for (const auto& tracker : trackers_) result.push_back(tracker->status());
  return result;
}

}  // namespace cloth_sim
