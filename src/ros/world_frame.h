#pragma once
/// \file Poses in any tf frame as poses in the world.

#include <geometry_msgs/TransformStamped.h>
#include <std_msgs/Header.h>
#include <tf2_ros/buffer.h>

#include <string>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// The frame of all world quantities, and what tf knows of the others.
class WorldFrame {
 public:
  /// \param buffer  must outlive this.
  WorldFrame(const tf2_ros::Buffer& buffer, std::string frame)
      : buffer_(buffer), frame_(std::move(frame)) {}

  /// A pose in the frame and at the time of `header` (stamp 0: the latest). Waits a moment for a
  /// transform that is about to arrive.
  /// \throws std::runtime_error if the frame is empty, unknown, or not known at that time.
  Pose toWorld(const Pose& pose, const std_msgs::Header& header) const;

  /// Where a frame was last seen.
  struct Sighting {
    Pose pose;
    double stamp = 0.0;  ///< [s]; 0: it does not move
  };
  /// \throws std::runtime_error if it is unknown.
  Sighting latest(const std::string& frame) const;

 private:
  void waitFor(const std_msgs::Header& header) const;
  geometry_msgs::TransformStamped lookUp(const std::string& frame, const ros::Time& time) const;

  const tf2_ros::Buffer& buffer_;
  std::string frame_;
};

}  // namespace cloth_sim
