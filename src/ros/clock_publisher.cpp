#include "clock_publisher.h"

#include <rosgraph_msgs/Clock.h>

#include <algorithm>

namespace cloth_sim {

ros::Time clockTime(double time) { return std::max(ros::Time(time), ros::TIME_MIN); }

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
