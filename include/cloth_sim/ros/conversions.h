#pragma once
/// \file Conversions between values of the core and messages. Pure functions; no node, no master.

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/time.h>

#include <vector>

#include "cloth_sim/BrokenSprings.h"
#include "cloth_sim/ClothCommand.h"
#include "cloth_sim/ClothContacts.h"
#include "cloth_sim/ClothFrame.h"
#include "cloth_sim/ClothState.h"
#include "cloth_sim/ClothTopology.h"
#include "cloth_sim/GraspEvent.h"
#include "cloth_sim/PhaseInfo.h"
#include "cloth_sim/TearEvents.h"
#include "cloth_sim/ros/observation.h"

namespace cloth_sim {

inline geometry_msgs::Point toPoint(const Vec3& value) {
  geometry_msgs::Point point;
  point.x = value.x();
  point.y = value.y();
  point.z = value.z();
  return point;
}
geometry_msgs::Vector3 toVector(const Vec3& value);
geometry_msgs::Quaternion toQuaternion(const Quat& value);
geometry_msgs::Pose toPoseMessage(const Pose& value);
Vec3 fromPoint(const geometry_msgs::Point& value);
Vec3 fromVector(const geometry_msgs::Vector3& value);
Quat fromQuaternion(const geometry_msgs::Quaternion& value);

/// Returns the wrench of a clamp about its origin, in its own axes [N, N m]. The core uses the axes
/// of the world.
geometry_msgs::Wrench clampFrameWrench(const ClampSnapshot& clamp);
/// Converts another wrench of the clamp, given in the axes of the world.
geometry_msgs::Wrench clampFrameWrench(const ClampSnapshot& clamp, const Wrench& worldAxes);

/// Returns the tf frame of a clamp: "cloth/clamp_left" for the clamp "left" of the node "/cloth".
std::string clampFrameId(const std::string& nodeName, const std::string& clamp);
/// Returns the tf frame of an obstacle: "cloth/obstacle_ball" for the obstacle "ball".
std::string obstacleFrameId(const std::string& nodeName, const std::string& obstacle);
/// Returns the tf frame of the scene of a node: "cloth" for the node "/cloth".
std::string sceneFrameId(const std::string& nodeName);

/// Returns the wrench of the cloth on an obstacle, in the frame of the obstacle [N, N m].
/// \param worldAxes  the wrench about the origin of the obstacle, in the axes of the world.
geometry_msgs::WrenchStamped toWrenchMessage(const Obstacle& obstacle, const Wrench& worldAxes,
                                             const ros::Time& stamp, const std::string& nodeName);

ClothTopology toTopologyMessage(const Topology& topology, const std_msgs::Header& header);
/// Fills `message`; its buffer is reused.
void fillFrame(const Snapshot& snapshot, const std_msgs::Header& header, ClothFrame& message);
/// Converts the snapshot of the observation that has figures.
ClothState toStateMessage(const Observation& observation, const std_msgs::Header& header);
/// Lists nothing if the snapshot has no contact points.
ClothContacts toContactsMessage(const Snapshot& snapshot, const std_msgs::Header& header);
ClothCommand toCommandMessage(const CommandRecord& record, const std_msgs::Header& header);
PhaseInfo toPhaseInfo(const PhaseRecord& record);
GraspEvent toGraspEventMessage(const GripEvent& event, const std_msgs::Header& header);
TearEvents toEventsMessage(const std::vector<FailureEvent>& events, const std_msgs::Header& header);
geometry_msgs::TransformStamped toTransform(const Pose& pose, const ros::Time& stamp,
                                            const std::string& world, const std::string& frame);

/// The positions of failed springs since the start or the last reset.
class FailureLog {
 public:
  void add(const std::vector<FailureEvent>& events);
  void clear() { positions_.clear(); }
  /// Returns the positions so far with the given counts.
  BrokenSprings toMessage(const BrokenCounts& counts, const std_msgs::Header& header) const;

 private:
  std::vector<float> positions_;  ///< x y z of each [m]
};

}  // namespace cloth_sim
