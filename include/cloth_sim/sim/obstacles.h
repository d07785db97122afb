#pragma once
/// \file The obstacles of a simulation: where they are, what guides them, and the cloth's contacts.

#include "cloth_sim/clamp/clamp.h"
#include "cloth_sim/contact/collider.h"
#include "cloth_sim/sim/obstacle_guides.h"

namespace cloth_sim {

/// Colliders that move by a velocity of their own or follow a target, and the contacts of the
/// last step with them.
class Obstacles {
 public:
  explicit Obstacles(ColliderSet colliders) : colliders_(std::move(colliders)) {}

  const ColliderSet& colliders() const { return colliders_; }
  const Contacts& contacts() const { return contacts_; }
  Contacts& contacts() { return contacts_; }
  std::vector<std::string> names() const;
  bool has(const std::string& obstacle) const { return colliders_.find(obstacle) != nullptr; }

  /// Puts an obstacle at a pose, from where it moves at `velocity` [m/s]; it follows no target any
  /// more. Does nothing if there is no obstacle of that name.
  /// \param time  now [s].
  void place(const std::string& obstacle, const Pose& pose, const Vec3& velocity, double time);
  /// Lets an obstacle move on from where it is, at `velocity` [m/s] and `angularVelocity` [rad/s];
  /// otherwise as `place`.
  void setVelocity(const std::string& obstacle, const Vec3& velocity, double time,
                   const Vec3& angularVelocity = Vec3::Zero());
  /// Lets an obstacle follow a moving target from the next step on, which places it there.
  void guide(const std::string& obstacle, const MovingPose& target);

  /// Turns the targets of guided obstacles into velocities for the step from `time` to `time + dt`.
  void steer(double time, double dt) { guides_.steer(time, dt, colliders_); }

  /// Finds the particles that may touch an obstacle before `state.t + dt`, and the faces and edges
  /// that may meet its sharp corners and edges, if they are to.
  void detect(const Model& model, const State& state, double dt, bool meetsSharpFeatures);

  /// Returns the wrench of the cloth on each obstacle: the mean over the last step, or over its
  /// last part if the step was divided; about the origin of the obstacle at `time` [s], in the axes
  /// of the world. Zero before the first step, and after a state was loaded.
  std::vector<Wrench> wrenches(double time) const;

  /// Tells whether some particle pushed at an obstacle in the last step.
  bool areTouched() const;
  /// Tells whether no obstacle moves by more than round-off in a step of `dt` [s].
  bool areStill(double time, double dt) const;

  /// Shifts every motion by `by` [s], as the clock jumps.
  void shiftTime(double by);

 private:
  friend class StateFormat;

  ColliderSet colliders_;
  ObstacleGuides guides_;
  Contacts contacts_;
  double span_ = 0.0;  ///< time for which contacts were detected last [s]
};

}  // namespace cloth_sim
