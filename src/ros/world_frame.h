#pragma once
/// \file Converts poses from any tf frame to the world frame.

#include <geometry_msgs/TransformStamped.h>
#include <std_msgs/Header.h>
#include <tf2_ros/buffer.h>

#include <string>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// The frame of all world quantities, with the transforms of other frames to it.
class WorldFrame {
 public:
  /// \param buffer  must outlive this.
  WorldFrame(const tf2_ros::Buffer& buffer, std::string frame)
      : buffer_(buffer), frame_(std::move(frame)) {}

  /// Converts a pose in the frame and at the time of `header` (stamp 0: the latest). Waits up to
  /// 0.2 s for a transform that has not arrived yet.
  /// \throws std::runtime_error if the frame is empty, unknown, or unknown at that time.
  Pose toWorld(const Pose& pose, const std_msgs::Header& header) const;

  /// The latest pose of a frame.
  struct Sighting {
    Pose pose;
    double stamp = 0.0;  ///< [s]; 0: a static transform
  };
  /// Looks up the latest pose of a frame. \throws std::runtime_error if it is unknown.
  Sighting latest(const std::string& frame) const;
  /// Looks up the latest pose of one frame in another. \throws std::runtime_error if it is unknown.
  Pose latestIn(const std::string& base, const std::string& frame) const;

 private:
  void waitFor(const std_msgs::Header& header) const;
  geometry_msgs::TransformStamped lookUp(const std::string& base, const std::string& frame,
                                         const ros::Time& time) const;

  const tf2_ros::Buffer& buffer_;
  std::string frame_;
};

}  // namespace cloth_sim
