/// \file expand_frames: makes frames of the compact ones in a bag, for those who draw frames. See
/// replay.launch.

#include <ros/ros.h>

#include "ros/compact_frame.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "expand_frames");
  ros::NodeHandle node;
  const ros::Publisher frames = node.advertise<cloth_sim::ClothFrame>("frame", 10);
  cloth_sim::ClothFrame frame;
  const auto expand = [&](const cloth_sim::CompactFrame::ConstPtr& compact) {
    if (frames.getNumSubscribers() == 0) return;
    const std::string error = cloth_sim::expandFrame(*compact, frame);
    if (error.empty()) return frames.publish(frame);
    ROS_WARN_STREAM_THROTTLE(10.0, "compact frame not shown: " << error);
  };
  const ros::Subscriber compactFrames =
      node.subscribe<cloth_sim::CompactFrame>("compact_frame", 10, expand);
  ros::spin();
  return 0;
}
