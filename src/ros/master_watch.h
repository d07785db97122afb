#pragma once
/// \file Keeps a node registered when its ROS master restarts.

#include <ros/node_handle.h>

#include <string>
#include <vector>

namespace cloth_sim {

/// Asks the master every `kPeriod` whether it knows the node, and registers all topics and services
/// again if it does not. roscpp does not do this: after a restart of the master, existing
/// connections go on, but new clients cannot find the node.
class MasterWatch {
 public:
  static constexpr double kPeriod = 2.0;  ///< between two questions, wall time [s]

  /// To be constructed after all services are advertised; topics may come and go.
  explicit MasterWatch(ros::NodeHandle& node);

 private:
  void check(const ros::WallTimerEvent& event);
  void registerAgain() const;

  std::vector<std::string> services_;
  ros::WallTimer timer_;
};

}  // namespace cloth_sim
