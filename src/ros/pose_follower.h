#pragma once
/// \file Follows a tf frame or a topic of poses.

#include <geometry_msgs/Pose.h>
#include <ros/node_handle.h>
#include <ros/steady_timer.h>
#include <ros/subscriber.h>

#include <chrono>
#include <functional>
#include <mutex>

#include "follow_source.h"
#include "pose_tracker.h"
#include "world_frame.h"

namespace cloth_sim {

/// A source that says nothing new for longer than this is lost [s].
constexpr double kSourceTimeout = 0.5;

/// Turns what a source says into targets in the world. While the source says nothing, is unknown to
/// tf, or makes no sense, what follows holds the last place that was said. It warns once, and says
/// so when the source is back.
class PoseFollower {
 public:
  /// Takes a new target; called from any thread, must not block.
  using Sink = std::function<void(const MovingPose&)>;

  /// \param who    for people: "clamp left".
  /// \param world  must outlive this.
  /// \param rate   at which tf is looked at [Hz].
  PoseFollower(ros::NodeHandle& node, std::string who, const FollowSource& source,
               const WorldFrame& world, double rate, Sink sink);

  FollowStatus status() const;

 private:
  using Clock = std::chrono::steady_clock;

  void lookAtFrame();
  void onPose(const std_msgs::Header& header, const geometry_msgs::Pose& pose);
  void take(double stamp, const Pose& pose);
  void watch();
  void miss(const std::string& reason);

  std::string who_;
  FollowSource source_;
  const WorldFrame& world_;
  Sink sink_;

  mutable std::mutex mutex_;
  PoseTracker tracker_;
  Clock::time_point lastNews_ = Clock::now();
  bool isStatic_ = false;
  std::string complaint_;  ///< what was wrong when the source was last looked at
  FollowStatus::State state_ = FollowStatus::State::kWaiting;

  // Last: their callbacks begin when everything above is there.
  ros::Subscriber subscriber_;
  ros::SteadyTimer timer_;
};

}  // namespace cloth_sim
