#pragma once
/// \file Efforts of the joints of a robot.

#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <sensor_msgs/JointState.h>

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace cloth_sim {

/// Keeps the latest efforts of joints, from the topic `joint_states`. Thread-safe.
///
/// roscpp does not wait for running callbacks when a subscriber goes (since 1.15), so callbacks
/// share the ownership while they run.
class JointEfforts : public std::enable_shared_from_this<JointEfforts> {
 public:
  /// Subscribes in the namespace of the node. \param joints  names of those that are kept.
  static std::shared_ptr<JointEfforts> subscribe(const std::vector<std::string>& joints);

  /// Returns the effort of a joint [N] or [N m]; nothing if no message had it.
  std::optional<double> of(const std::string& joint) const;

 private:
  JointEfforts() = default;
  void onStates(const sensor_msgs::JointState& states);

  mutable std::mutex mutex_;
  std::map<std::string, std::optional<double>> byJoint_;
  ros::Subscriber subscriber_;
};

}  // namespace cloth_sim
