#pragma once
/// \file Simulated time for everybody, on /clock.

#include <ros/node_handle.h>
#include <ros/publisher.h>

namespace cloth_sim {

/// Simulated time as a stamp. Time 0 is stamped 1 ns, since a stamp of 0 means "none" in ROS.
ros::Time clockTime(double time);

/// Sends /clock, latched, after every step; or nothing.
class ClockPublisher {
 public:
  ClockPublisher(ros::NodeHandle& node, bool enabled);

  /// \param time  simulated [s]. From one thread at a time.
  void tell(double time);

 private:
  ros::Publisher publisher_;  ///< of nothing, if it is not enabled
};

}  // namespace cloth_sim
