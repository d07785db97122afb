#pragma once
/// \file Obstacles that track tf frames or topics of poses.

#include <memory>
#include <vector>

#include "parameters.h"
#include "pose_tracker.h"
#include "simulation_thread.h"

namespace cloth_sim {

/// The trackers of all obstacles in the parameter ~follow_obstacle.
class ObstacleTrackers {
 public:
  /// All arguments must outlive this.
  ObstacleTrackers(ros::NodeHandle& node, const NodeParameters& parameters, const WorldFrame& world,
                   SimulationThread& simulation);

  /// Has obstacles follow their sources again, after a reset.
  void repeat();

  std::vector<TrackingStatus> statuses() const;

 private:
  std::vector<std::shared_ptr<PoseTracker>> trackers_;
};

}  // namespace cloth_sim
