#pragma once
/// \file Obstacles that follow tf frames or topics of poses.

#include <memory>
#include <vector>

#include "parameters.h"
#include "pose_follower.h"
#include "simulation_thread.h"

namespace cloth_sim {

class ObstacleFollowers {
 public:
  /// All must outlive this.
  ObstacleFollowers(ros::NodeHandle& node, const NodeParameters& parameters,
                    const WorldFrame& world, SimulationThread& simulation);

  std::vector<FollowStatus> statuses() const;

 private:
  std::vector<std::unique_ptr<PoseFollower>> followers_;
};

}  // namespace cloth_sim
