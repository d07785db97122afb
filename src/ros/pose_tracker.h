#pragma once
/// \file Tracks a tf frame or a topic of poses.

#include <geometry_msgs/Pose.h>
#include <ros/node_handle.h>
#include <ros/steady_timer.h>
#include <ros/subscriber.h>

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>

#include "motion_estimator.h"
#include "pose_source.h"
#include "world_frame.h"

namespace cloth_sim {

/// Turns the poses of a source into moving targets in the world frame. While the source is silent,
/// unknown to tf, or sends invalid poses, the target stays at the last valid pose. The tracker
/// warns once when the source is lost, and reports once when it is back. After a reset, which puts
/// what it moves back to where it began, its owner has it say its place again.
///
/// roscpp does not wait for running callbacks when a timer or a subscriber goes (since 1.15), so
/// callbacks share the ownership of the tracker while they run.
class PoseTracker : public std::enable_shared_from_this<PoseTracker> {
 public:
  /// Receives each new target; called from any thread, must not block.
  using Sink = std::function<void(const MovingPose&)>;

  /// Begins to track a source.
  /// \param name   of what is moved, for messages to the user: "clamp left".
  /// \param world  must outlive this.
  /// \param rate   of tf look-ups [Hz].
  static std::shared_ptr<PoseTracker> track(ros::NodeHandle& node, std::string name,
                                            const PoseSource& source, const WorldFrame& world,
                                            double rate, Sink sink);

  /// Passes on the last valid pose again, at rest, if there is one.
  void repeat();

  TrackingStatus status() const;

 private:
  using Clock = std::chrono::steady_clock;

  PoseTracker(std::string name, const PoseSource& source, const WorldFrame& world, Sink sink);
  /// A callback that does nothing once the tracker is gone.
  template <typename... Arguments, typename Body>
  auto whileAlive(const Body& body);
  void subscribe(ros::NodeHandle& node);
  void lookUpFrame();
  void onPose(const std_msgs::Header& header, const geometry_msgs::Pose& pose);
  void accept(double stamp, const Pose& pose);
  void reject(const std::string& reason);
  void onTimer();

  std::string name_;
  PoseSource source_;
  const WorldFrame& world_;
  Sink sink_;

  mutable std::mutex mutex_;
  MotionEstimator motion_;
  Clock::time_point lastNews_ = Clock::now();
  ros::Time lastNewsTime_;  ///< the same by ROS time
  bool isStatic_ = false;   ///< the source is a static transform: its silence is no loss
  std::string problem_;     ///< with the source at the last look; "" if there was none
  TrackingStatus::State state_ = TrackingStatus::State::kWaiting;

  ros::Subscriber subscriber_;
  ros::SteadyTimer timer_;
};

}  // namespace cloth_sim
