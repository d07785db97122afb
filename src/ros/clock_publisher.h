#pragma once
/// \file Publishes simulated time on /clock.

#include <ros/node_handle.h>
#include <ros/publisher.h>

namespace cloth_sim {

/// Returns simulated time [s] as a stamp. Time 0 is stamped 1 ns, since a stamp of 0 means "none"
/// in ROS.
ros::Time clockTime(double time);

/// Publishes /clock, latched, after every step, if it is enabled.
class ClockPublisher {
 public:
  ClockPublisher(ros::NodeHandle& node, bool enabled);

  /// Publishes a simulated time [s]. To be called from one thread at a time.
  void tell(double time);

 private:
  ros::Publisher publisher_;  ///< invalid if it is not enabled
};

}  // namespace cloth_sim
