#pragma once
/// \file The wrench topics of the obstacles.

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <string>
#include <vector>

#include "cloth_sim/sim/snapshot.h"

namespace cloth_sim {

/// Publishes the wrench of the cloth on each obstacle, if somebody subscribes to it.
class ObstacleWrenches {
 public:
  /// \param node  must outlive this; the topics are obstacles/<name>/wrench below it.
  explicit ObstacleWrenches(ros::NodeHandle& node) : node_(node) {}

  /// Opens the topics of the obstacles of a scene, once: obstacles neither come nor go.
  void open(const Snapshot& snapshot);
  std::uint32_t subscribers() const;
  /// \param nodeName  prefix of the obstacles' tf frames.
  void send(const Snapshot& snapshot, const ros::Time& stamp, const std::string& nodeName);

 private:
  ros::NodeHandle& node_;
  std::vector<ros::Publisher> publishers_;  ///< by obstacle
};

}  // namespace cloth_sim
