#include "obstacle_followers.h"

#include "submit.h"

namespace cloth_sim {

ObstacleFollowers::ObstacleFollowers(ros::NodeHandle& node, const NodeParameters& parameters,
                                     const WorldFrame& world, SimulationThread& simulation) {
  for (const auto& [obstacle, source] : parameters.followObstacle) {
    const PoseFollower::Sink sink = [&simulation, name = obstacle](const MovingPose& target) {
      submit("follow_obstacle/" + name, Command{GuideObstacle{name, target}}, simulation);
    };
    followers_.push_back(std::make_unique<PoseFollower>(node, "obstacle " + obstacle, source, world,
                                                        parameters.rateFollow, sink));
  }
}

std::vector<FollowStatus> ObstacleFollowers::statuses() const {
  std::vector<FollowStatus> result;
  for (const auto& follower : followers_) result.push_back(follower->status());
  return result;
}

}  // namespace cloth_sim
