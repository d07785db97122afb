#pragma once
/// \file Obstacles and clamps that track the links of a robot by tf.

#include <ros/node_handle.h>

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "joint_efforts.h"
#include "pose_tracker.h"
#include "robot.h"
#include "simulation_thread.h"

namespace cloth_sim {

/// Moves the obstacles of a robot with their links, and clamps with the plates of its grippers: a
/// clamp closes and opens as the plates do, and holds with the force of their motor. Thread-safe.
class RobotTrackers {
 public:
  /// All arguments but `robot` must outlive this.
  /// \param rate  of tf look-ups [Hz].
  RobotTrackers(ros::NodeHandle& node, const Robot& robot, double rate, const WorldFrame& world,
                SimulationThread& simulation);

  /// Has obstacles and clamps follow their links again, after a reset.
  void repeat();

  std::vector<TrackingStatus> statuses() const;

 private:
  using Obstacles = std::vector<RobotObstacle>;

  void trackLink(ros::NodeHandle& node, const std::string& link, const Obstacles& obstacles);
  void trackGripper(ros::NodeHandle& node, const RobotGripper& gripper);
  void place(const Obstacles& obstacles, const MovingPose& link);
  void moveClamp(const RobotGripper& gripper, const MovingPose& base);
  std::optional<double> forceOf(const RobotGripper& gripper,
                                const std::array<Vec3, 2>& middles) const;

  double rate_;
  const WorldFrame& world_;
  SimulationThread& simulation_;

  /// The last commands to a clamp.
  struct Told {
    std::optional<Pose> pose;     ///< in the world
    std::optional<double> gap;    ///< between the plates [m]
    std::optional<double> force;  ///< of the grip [N]
  };
  std::mutex mutex_;
  std::map<std::string, Told> told_;  ///< by clamp

  std::shared_ptr<JointEfforts> efforts_;  ///< of motors; null without any
  std::vector<std::shared_ptr<PoseTracker>> trackers_;
};

}  // namespace cloth_sim
