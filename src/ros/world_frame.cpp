#include "world_frame.h"

#include <stdexcept>

#include "cloth_sim/ros/conversions.h"

namespace cloth_sim {
namespace {

constexpr double kTfTimeout = 0.2;  ///< for a transform that is about to arrive [s]
constexpr double kTfPoll = 0.005;   ///< [s]

Pose toPose(const geometry_msgs::Transform& transform) {
  return {fromVector(transform.translation), fromQuaternion(transform.rotation).normalized()};
}

}  // namespace

Pose WorldFrame::toWorld(const Pose& pose, const std_msgs::Header& header) const {
  if (header.frame_id.empty()) throw std::runtime_error("header.frame_id is empty");
  if (header.frame_id == frame_ || header.frame_id == "/" + frame_) return pose;
  waitFor(header);
  const Pose frame = toPose(lookUp(header.frame_id, header.stamp).transform);
  return {frame.toWorld(pose.position), (frame.orientation * pose.orientation).normalized()};
}

/// By the wall's clock: with simulated time, a paused simulation would make it wait for ever.
void WorldFrame::waitFor(const std_msgs::Header& header) const {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kTfTimeout);
  while (!buffer_.canTransform(frame_, header.frame_id, header.stamp) &&
         ros::WallTime::now() < end) {
    ros::WallDuration(kTfPoll).sleep();
  }
}

WorldFrame::Sighting WorldFrame::latest(const std::string& frame) const {
  const geometry_msgs::TransformStamped found = lookUp(frame, ros::Time(0));
  return {toPose(found.transform), found.header.stamp.toSec()};
}

/// What tf says of a frame that it does not know may be about the other one.
geometry_msgs::TransformStamped WorldFrame::lookUp(const std::string& frame,
                                                   const ros::Time& time) const {
  try {
    return buffer_.lookupTransform(frame_, frame, time);
  } catch (const tf2::TransformException& error) {
    throw std::runtime_error("no transform from '" + frame + "' to '" + frame_ +
                             "': " + error.what());
  }
}

}  // namespace cloth_sim
