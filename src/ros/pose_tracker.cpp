#include "pose_tracker.h"

#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/console.h>

#include <utility>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/validation.h"

namespace cloth_sim {

template <typename... Arguments, typename Body>
auto PoseTracker::whileAlive(const Body& body) {
  return [weak = weak_from_this(), body](const Arguments&... arguments) {
    if (const std::shared_ptr<PoseTracker> alive = weak.lock()) body(*alive, arguments...);
  };
}

std::shared_ptr<PoseTracker> PoseTracker::track(ros::NodeHandle& node, std::string name,
                                                const PoseSource& source, const WorldFrame& world,
                                                double rate, Sink sink) {
  const std::shared_ptr<PoseTracker> tracker(
      new PoseTracker(std::move(name), source, world, std::move(sink)));
  tracker->subscribe(node);
  tracker->timer_ = node.createSteadyTimer(
      ros::WallDuration(1.0 / rate),
      tracker->whileAlive<ros::SteadyTimerEvent>(
          [](PoseTracker& it, const ros::SteadyTimerEvent&) { it.onTimer(); }));
  return tracker;
}

PoseTracker::PoseTracker(std::string name, const PoseSource& source, const WorldFrame& world,
                         Sink sink)
    : name_(std::move(name)), source_(source), world_(world), sink_(std::move(sink)) {}

/// Subscribes to the source if it is a topic; a frame is looked up by the timer.
void PoseTracker::subscribe(ros::NodeHandle& node) {
  if (source_.kind == PoseSource::Kind::kPose) {
    const boost::function<void(const geometry_msgs::PoseStamped&)> callback =
        whileAlive<geometry_msgs::PoseStamped>(
            [](PoseTracker& tracker, const geometry_msgs::PoseStamped& it) {
              tracker.onPose(it.header, it.pose);
            });
    subscriber_ = node.subscribe<geometry_msgs::PoseStamped, const geometry_msgs::PoseStamped&>(
        source_.name, 1, callback);
  } else if (source_.kind == PoseSource::Kind::kOdometry) {
    const boost::function<void(const nav_msgs::Odometry&)> callback =
        whileAlive<nav_msgs::Odometry>([](PoseTracker& tracker, const nav_msgs::Odometry& it) {
          tracker.onPose(it.header, it.pose.pose);
        });
    subscriber_ =
        node.subscribe<nav_msgs::Odometry, const nav_msgs::Odometry&>(source_.name, 1, callback);
  }
}

void PoseTracker::repeat() {
  std::optional<MovingPose> rest;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    rest = motion_.rest();
  }
  if (rest) sink_(*rest);
}

TrackingStatus PoseTracker::status() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool tracking = state_ == TrackingStatus::State::kTracking;
  return {name_, toString(source_), state_, tracking ? "" : problem_};
}

void PoseTracker::lookUpFrame() {
  try {
    const WorldFrame::Sighting seen = world_.latest(source_.name);
    accept(seen.stamp, seen.pose);
  } catch (const std::runtime_error& error) {
    reject(error.what());
  }
}

void PoseTracker::onPose(const std_msgs::Header& header, const geometry_msgs::Pose& message) {
  Pose pose{fromPoint(message.position), fromQuaternion(message.orientation)};
  if (const std::string error = validationError(pose); !error.empty()) return reject(error);
  pose.orientation.normalize();
  try {
    const Pose inWorld = world_.toWorld(pose, header);
    // An unstamped pose is taken as current.
    const ros::Time stamp = header.stamp.isZero() ? ros::Time::now() : header.stamp;
    accept(stamp.toSec(), inWorld);
  } catch (const std::runtime_error& error) {
    reject(error.what());
  }
}

void PoseTracker::accept(double stamp, const Pose& pose) {
  std::optional<MovingPose> target;
  bool isBack = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    isStatic_ = stamp == 0.0;
    problem_.clear();
    target = motion_.add(stamp, pose);
    if (!target && isStatic_ && source_.repeatsStatic) target = motion_.rest();
    if (target) {
      lastNews_ = Clock::now();
      lastNewsTime_ = ros::Time::now();
    }
    if (target || isStatic_) {
      isBack =
          std::exchange(state_, TrackingStatus::State::kTracking) == TrackingStatus::State::kLost;
    }
  }
  if (target) sink_(*target);
  if (isBack) ROS_INFO_STREAM(name_ << " follows " << toString(source_) << " again");
}

void PoseTracker::reject(const std::string& reason) {
  const std::lock_guard<std::mutex> lock(mutex_);
  isStatic_ = false;
  problem_ = reason;
}

/// Looks up the frame, and declares the source lost after too long without a new pose.
void PoseTracker::onTimer() {
  if (source_.kind == PoseSource::Kind::kFrame) lookUpFrame();
  std::string reason;
  std::optional<MovingPose> rest;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const bool waits = state_ == TrackingStatus::State::kWaiting;
    const double wall = std::chrono::duration<double>(Clock::now() - lastNews_).count();
    const double time = (ros::Time::now() - lastNewsTime_).toSec();
    if (waits ? wall < source_.patience : silence(wall, time) < kSourceTimeout) return;
    if (isStatic_ || state_ == TrackingStatus::State::kLost) return;
    state_ = TrackingStatus::State::kLost;
    if (problem_.empty()) problem_ = "it says nothing new";
    reason = problem_;
    rest = motion_.rest();
  }
  if (rest) sink_(*rest);
  ROS_WARN_STREAM(name_ << " holds its place: " << toString(source_) << " is lost (" << reason
                        << ")");
}

}  // namespace cloth_sim
