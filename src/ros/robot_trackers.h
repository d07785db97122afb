#pragma once
/// \file Obstacles and clamps that track the links of a robot by tf.

#include <ros/node_handle.h>
#include <ros/steady_timer.h>

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "pose_tracker.h"
#include "robot.h"
#include "simulation_thread.h"

namespace cloth_sim {

/// Moves the obstacles of a robot with their links, and clamps with the plates of its grippers:
/// a clamp closes and opens as the plates do. Thread-safe.
class RobotTrackers {
 public:
  /// All arguments but `robot` must outlive this.
  /// \param rate  of tf look-ups [Hz].
  RobotTrackers(ros::NodeHandle& node, const Robot& robot, double rate, const WorldFrame& world,
                SimulationThread& simulation);

  std::vector<TrackingStatus> statuses() const;

 private:
  using Obstacles = std::vector<RobotObstacle>;

  void trackLink(ros::NodeHandle& node, const std::string& link, const Obstacles& obstacles);
  void trackGripper(ros::NodeHandle& node, const RobotGripper& gripper);
  void place(const Obstacles& obstacles, const MovingPose& link);
  void moveClamp(const RobotGripper& gripper, const MovingPose& base);
  void placeAllAfterReset();

  double rate_;
  const WorldFrame& world_;
  SimulationThread& simulation_;
  std::map<std::string, Obstacles> obstacles_;  ///< by link

  mutable std::mutex mutex_;
  std::map<std::string, MovingPose> links_;  ///< where each link was last
  std::map<std::string, double> gaps_;       ///< between the plates of each clamp, as last told [m]
  std::uint64_t resets_ = 0;                 ///< of the simulation, as last seen

  std::vector<std::shared_ptr<PoseTracker>> trackers_;
  ros::SteadyTimer timer_;
};

}  // namespace cloth_sim
