#include "pose_follower.h"

#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/console.h>

#include <utility>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/validation.h"

namespace cloth_sim {
PoseFollower::PoseFollower(ros::NodeHandle& node, std::string who, const FollowSource& source,
                           const WorldFrame& world, double rate, Sink sink)
    : who_(std::move(who)), source_(source), world_(world), sink_(std::move(sink)) {
  if (source.kind == FollowSource::Kind::kPose) {
    const boost::function<void(const geometry_msgs::PoseStamped&)> callback =
        [this](const geometry_msgs::PoseStamped& it) { onPose(it.header, it.pose); };
    subscriber_ = node.subscribe<geometry_msgs::PoseStamped, const geometry_msgs::PoseStamped&>(
        source.name, 1, callback);
  } else if (source.kind == FollowSource::Kind::kOdometry) {
    const boost::function<void(const nav_msgs::Odometry&)> callback =
        [this](const nav_msgs::Odometry& it) { onPose(it.header, it.pose.pose); };
    subscriber_ =
        node.subscribe<nav_msgs::Odometry, const nav_msgs::Odometry&>(source.name, 1, callback);
  }
  timer_ = node.createSteadyTimer(ros::WallDuration(1.0 / rate),
                                  [this](const ros::SteadyTimerEvent&) { watch(); });
}

FollowStatus PoseFollower::status() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool follows = state_ == FollowStatus::State::kFollowing;
  return {who_, toString(source_), state_, follows ? "" : complaint_};
}

void PoseFollower::lookAtFrame() {
  try {
    const WorldFrame::Sighting seen = world_.latest(source_.name);
    take(seen.stamp, seen.pose);
  } catch (const std::runtime_error& error) {
    miss(error.what());
  }
}

void PoseFollower::onPose(const std_msgs::Header& header, const geometry_msgs::Pose& message) {
  Pose pose{fromPoint(message.position), fromQuaternion(message.orientation)};
  if (!validationError(pose).empty())
    return miss("what it says is no finite pose with a unit quaternion");
  pose.orientation.normalize();
  try {
    const Pose inWorld = world_.toWorld(pose, header);
    // Unstamped poses are of now.
    const ros::Time stamp = header.stamp.isZero() ? ros::Time::now() : header.stamp;
    take(stamp.toSec(), inWorld);
  } catch (const std::runtime_error& error) {
    miss(error.what());
  }
}

void PoseFollower::take(double stamp, const Pose& pose) {
  std::optional<MovingPose> target;
  bool isBack = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    isStatic_ = stamp == 0.0;
    complaint_.clear();
    target = tracker_.add(stamp, pose);
    if (target) lastNews_ = Clock::now();
    if (target || isStatic_) {
      isBack = std::exchange(state_, FollowStatus::State::kFollowing) == FollowStatus::State::kLost;
    }
  }
  if (target) sink_(*target);
  if (isBack) ROS_INFO_STREAM(who_ << " follows " << toString(source_) << " again");
}

void PoseFollower::miss(const std::string& reason) {
  const std::lock_guard<std::mutex> lock(mutex_);
  isStatic_ = false;
  complaint_ = reason;
}

/// Looks for news, and notices when there have been none for too long.
void PoseFollower::watch() {
  if (source_.kind == FollowSource::Kind::kFrame) lookAtFrame();
  std::string reason;
  std::optional<MovingPose> rest;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const double silence = std::chrono::duration<double>(Clock::now() - lastNews_).count();
    if (isStatic_ || silence < kSourceTimeout || state_ == FollowStatus::State::kLost) return;
    state_ = FollowStatus::State::kLost;
    if (complaint_.empty()) complaint_ = "it says nothing new";
    reason = complaint_;
    rest = tracker_.rest();
  }
  if (rest) sink_(*rest);
  ROS_WARN_STREAM(who_ << " holds its place: " << toString(source_) << " is lost (" << reason
                       << ")");
}

}  // namespace cloth_sim
