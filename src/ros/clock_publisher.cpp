#include "clock_publisher.h"

#include <rosgraph_msgs/Clock.h>

#include <algorithm>

namespace cloth_sim {

/// ros::Time ends at 2^32 s, and throws beyond: from there on, the clock stands still.
ros::Time clockTime(double time) {
  if (!(time < ros::TIME_MAX.toSec())) return ros::TIME_MAX;
  return std::max(ros::Time(std::max(time, 0.0)), ros::TIME_MIN);
}

ClockPublisher::ClockPublisher(ros::NodeHandle& node, bool enabled) {
  if (enabled) publisher_ = node.advertise<rosgraph_msgs::Clock>("/clock", 10, true);
}

void ClockPublisher::tell(double time) {
  if (!publisher_) return;
  rosgraph_msgs::Clock message;
  message.clock = clockTime(time);
  publisher_.publish(message);
}

}  // namespace cloth_sim
