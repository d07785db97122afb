#pragma once
/// \file Obstacles that follow targets from outside of the simulation.

#include <string>
#include <vector>

#include "cloth_sim/clamp/moving_pose.h"
#include "cloth_sim/contact/collider.h"

namespace cloth_sim {

/// An obstacle that would have to be faster to reach its target is placed there [m/s].
constexpr double kFastestObstacle = 10.0;

/// The targets of guided obstacles, by the name of the obstacle.
class ObstacleGuides {
 public:
  /// Guides an obstacle to `target`, in place of the target that it had. Where it had none, the
  /// next step places it there: it sweeps nothing along on its way to where it begins.
  void set(const std::string& obstacle, const MovingPose& target);
  /// Stops guiding an obstacle; it goes on at the velocity that it has.
  void drop(const std::string& obstacle);

  /// Tells whether every guided collider is, at `time` [s], where its target stays.
  bool areIdle(double time, const ColliderSet& colliders) const;

  /// Gives every guided collider the velocities with which it reaches its target at `time + dt`,
  /// or places it there. Advances the targets by `dt` [s].
  void steer(double time, double dt, ColliderSet& colliders);

 private:
  struct Guide {
    std::string obstacle;
    MovingPose target;
    bool hasBegun = false;  ///< the obstacle is where the target was when the last step ended

    template <class Archive>
    void serialize(Archive& archive) {
      archive(obstacle, target, hasBegun);
    }
  };

  friend class cereal::access;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(guides_);
  }

  std::vector<Guide>::iterator find(const std::string& obstacle);

  std::vector<Guide> guides_;
};

}  // namespace cloth_sim
