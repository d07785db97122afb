#include "joint_efforts.h"

#include <algorithm>

namespace cloth_sim {

std::shared_ptr<JointEfforts> JointEfforts::subscribe(const std::vector<std::string>& joints) {
  const std::shared_ptr<JointEfforts> efforts(new JointEfforts());
  for (const std::string& joint : joints) efforts->byJoint_[joint] = std::nullopt;
  const boost::function<void(const sensor_msgs::JointState&)> callback =
      [weak = efforts->weak_from_this()](const sensor_msgs::JointState& states) {
        if (const std::shared_ptr<JointEfforts> alive = weak.lock()) alive->onStates(states);
      };
  // Drivers of arms and of grippers may share the topic: the latest messages of all are needed.
  constexpr int kQueue = 20;
  ros::NodeHandle node;
  efforts->subscriber_ = node.subscribe<sensor_msgs::JointState, const sensor_msgs::JointState&>(
      "joint_states", kQueue, callback);
  return efforts;
}

/// Joints without an effort have a shorter list, or none.
void JointEfforts::onStates(const sensor_msgs::JointState& states) {
  const std::size_t known = std::min(states.name.size(), states.effort.size());
  const std::lock_guard<std::mutex> lock(mutex_);
  for (std::size_t k = 0; k < known; ++k) {
    const auto kept = byJoint_.find(states.name[k]);
    if (kept != byJoint_.end()) kept->second = states.effort[k];
  }
}

std::optional<double> JointEfforts::of(const std::string& joint) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = byJoint_.find(joint);
  return found == byJoint_.end() ? std::nullopt : found->second;
}

}  // namespace cloth_sim
