#include "world_frame.h"

#include <stdexcept>

#include "cloth_sim/ros/conversions.h"

namespace cloth_sim {
namespace {

constexpr double kTfTimeout = 0.2;  ///< longest wait for a transform [s]
constexpr double kTfPoll = 0.005;   ///< period of the polling [s]

Pose toPose(const geometry_msgs::Transform& transform) {
  return {fromVector(transform.translation), fromQuaternion(transform.rotation).normalized()};
}

}  // namespace

Pose WorldFrame::toWorld(const Pose& pose, const std_msgs::Header& header) const {
  if (header.frame_id.empty()) throw std::runtime_error("header.frame_id is empty");
  if (header.frame_id == frame_ || header.frame_id == "/" + frame_) return pose;
  waitFor(header);
  const Pose frame = toPose(lookUp(frame_, header.frame_id, header.stamp).transform);
  return {frame.toWorld(pose.position), (frame.orientation * pose.orientation).normalized()};
}

/// Waits by wall time: by simulated time, a paused simulation would block it for ever.
void WorldFrame::waitFor(const std_msgs::Header& header) const {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kTfTimeout);
  while (!buffer_.canTransform(frame_, header.frame_id, header.stamp) &&
         ros::WallTime::now() < end) {
    ros::WallDuration(kTfPoll).sleep();
  }
}

WorldFrame::Sighting WorldFrame::latest(const std::string& frame) const {
  const geometry_msgs::TransformStamped found = lookUp(frame_, frame, ros::Time(0));
  return {toPose(found.transform), found.header.stamp.toSec()};
}

Pose WorldFrame::latestIn(const std::string& base, const std::string& frame) const {
  return toPose(lookUp(base, frame, ros::Time(0)).transform);
}

/// Looks up a transform. The error names both frames, because that of tf may name only one.
geometry_msgs::TransformStamped WorldFrame::lookUp(const std::string& base,
                                                   const std::string& frame,
                                                   const ros::Time& time) const {
  try {
    return buffer_.lookupTransform(base, frame, time);
  } catch (const tf2::TransformException& error) {
    throw std::runtime_error("no transform from '" + frame + "' to '" + base +
                             "': " + error.what());
  }
}

}  // namespace cloth_sim
