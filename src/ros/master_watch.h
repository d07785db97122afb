#pragma once
/// \file A node that outlives its ROS master.

#include <ros/node_handle.h>

#include <string>
#include <vector>

namespace cloth_sim {

/// A master that was restarted knows nobody, and roscpp does not tell it again: connections that
/// there are go on, but nobody new finds the node. This one looks every `kPeriod` whether the
/// master still knows the node, and registers all its topics and services again if not.
class MasterWatch {
 public:
  static constexpr double kPeriod = 2.0;  ///< between two looks, wall time [s]

  /// To be made when all services are advertised; topics may come and go.
  explicit MasterWatch(ros::NodeHandle& node);

 private:
  void look(const ros::WallTimerEvent& event);
  void registerAgain() const;

  std::vector<std::string> services_;
  ros::WallTimer timer_;
};

}  // namespace cloth_sim
