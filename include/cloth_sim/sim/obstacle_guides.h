#pragma once
/// \file Obstacles that follow something outside of the simulation.

#include <string>
#include <vector>

#include "cloth_sim/clamp/moving_pose.h"
#include "cloth_sim/contact/collider.h"

namespace cloth_sim {

/// Which obstacles follow which targets.
class ObstacleGuides {
 public:
  /// From now on the obstacle follows `target`, in place of what it followed.
  void set(const std::string& obstacle, const MovingPose& target);
  /// It follows nothing, and goes on as it moves.
  void drop(const std::string& obstacle);

  /// Whether every guided collider, at `time`, is where its target stays.
  bool areIdle(double time, const ColliderSet& colliders) const;

  /// Gives every guided collider the velocity with which it is at its target after `dt`; its
  /// orientation is that one's at once. Targets move on.
  void steer(double time, double dt, ColliderSet& colliders);

 private:
  struct Guide {
    std::string obstacle;
    MovingPose target;

    template <class Archive>
    void serialize(Archive& archive) {
      archive(obstacle, target);
    }
  };

  friend class cereal::access;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(guides_);
  }

  std::vector<Guide> guides_;
};

}  // namespace cloth_sim
