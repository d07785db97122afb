#include "obstacle_trackers.h"

#include "submit.h"

namespace cloth_sim {

ObstacleTrackers::ObstacleTrackers(ros::NodeHandle& node, const NodeParameters& parameters,
                                   const WorldFrame& world, SimulationThread& simulation) {
  for (const auto& [obstacle, source] : parameters.obstacleSources) {
    const PoseTracker::Sink sink = [&simulation, name = obstacle](const MovingPose& target) {
      submit("follow_obstacle/" + name, Command{GuideObstacle{name, target}}, simulation);
    };
    trackers_.push_back(PoseTracker::track(node, "obstacle " + obstacle, source, world,
                                           parameters.rateTracking, sink));
  }
}

void ObstacleTrackers::repeat() {
  for (const auto& tracker : trackers_) tracker->repeat();
}

std::vector<TrackingStatus> ObstacleTrackers::statuses() const {
  std::vector<TrackingStatus> result;
  for (const auto& tracker : trackers_) result.push_back(tracker->status());
  return result;
}

}  // namespace cloth_sim
