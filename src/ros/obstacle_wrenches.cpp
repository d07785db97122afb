#include "obstacle_wrenches.h"

#include "cloth_sim/ros/conversions.h"

namespace cloth_sim {

void ObstacleWrenches::open(const Snapshot& snapshot) {
  for (std::size_t k = publishers_.size(); k < snapshot.obstacles.size(); ++k) {
    publishers_.push_back(node_.advertise<geometry_msgs::WrenchStamped>(
        "obstacles/" + snapshot.obstacles[k].name + "/wrench", 10));
  }
}

std::uint32_t ObstacleWrenches::subscribers() const {
  std::uint32_t count = 0;
  for (const ros::Publisher& publisher : publishers_) count += publisher.getNumSubscribers();
  return count;
}

void ObstacleWrenches::send(const Snapshot& snapshot, const ros::Time& stamp,
                            const std::string& nodeName) {
  for (std::size_t k = 0; k < publishers_.size(); ++k) {
    if (publishers_[k].getNumSubscribers() == 0) continue;
    publishers_[k].publish(
        toWrenchMessage(snapshot.obstacles[k], snapshot.obstacleWrenches[k], stamp, nodeName));
  }
}

}  // namespace cloth_sim
