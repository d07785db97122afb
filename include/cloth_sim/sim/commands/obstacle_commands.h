#pragma once
/// \file Commands to obstacles: put one somewhere, or let it follow a target.

#include "cloth_sim/sim/command_basics.h"

namespace cloth_sim {

/// Puts an obstacle at a pose at once, from where it moves on at a velocity.
struct MoveObstacle {
  static constexpr const char* kKind = "move_obstacle";
  static constexpr Wakes kWakes = Wakes::kAlways;

  std::string obstacle;
  Pose pose;                     ///< in the world
  Vec3 velocity = Vec3::Zero();  ///< [m/s]

  std::string describe() const { return obstacle + " to " + toText(pose.position); }
  std::string validationError() const {
    if (!velocity.allFinite()) return "velocity: expected three finite numbers";
    return cloth_sim::validationError(pose);
  }
  CommandResult apply(SimulationParts& parts) const {
    if (!parts.obstacles.has(obstacle)) {
      return refuseUnknown("obstacle", obstacle, parts.obstacles.names());
    }
    parts.obstacles.place(obstacle, {pose.position, pose.orientation.normalized()}, velocity,
                          parts.time());
    return done();
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(obstacle, pose, velocity);
  }
};

/// Lets an obstacle go along with a target that moves: it is where the target is at the end of
/// every step. The first step places it there, as do those in which it would have to be faster than
/// kFastestObstacle; in the others it moves there. MoveObstacle, or a phase that gives the obstacle
/// a velocity, ends it.
struct GuideObstacle {
  static constexpr const char* kKind = "guide_obstacle";
  static constexpr Wakes kWakes = Wakes::kIfSomethingMoves;

  std::string obstacle;
  MovingPose target;  ///< in the world

  std::string describe() const { return obstacle + " to " + toText(target.pose.position); }
  std::string validationError() const { return cloth_sim::validationError(target); }
  CommandResult apply(SimulationParts& parts) const {
    if (!parts.obstacles.has(obstacle)) {
      return refuseUnknown("obstacle", obstacle, parts.obstacles.names());
    }
    parts.obstacles.guide(obstacle, normalized(target));
    return done();
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(obstacle, target);
  }
};

}  // namespace cloth_sim
