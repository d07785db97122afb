#pragma once
/// \file The pull at one particle by a pointer such as a mouse. An input to a step, like a clamp.

#include <string>
#include <vector>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/solver/solver.h"

namespace cloth_sim {

/// A half-line in the world.
struct Ray {
  Vec3 origin = Vec3::Zero();      ///< [m]
  Vec3 direction = Vec3::UnitX();  ///< of any length > 0

  template <class Archive>
  void serialize(Archive& archive) {
    archive(origin, direction);
  }
};

/// Returns why a ray cannot be used, in one sentence; empty if it can.
std::string validationError(const Ray& ray);

/// Pulls a particle along with a ray, at the distance from the ray's origin at which it was picked.
/// The particle follows as a kinematic target, with a time constant of 50 ms and at 1.5 m/s at
/// most.
///
/// The pull ends by itself when it has not been aimed for `kPatience` of simulated time, since the
/// program that pulls may vanish.
class Drag {
 public:
  /// Simulated time without `aim` after which the pull ends [s].
  static constexpr double kPatience = 1.0;
  /// Largest distance from the ray at which a particle is picked [m].
  static constexpr double kReach = 0.05;

  /// Picks the particle nearest to the ray; of those less than 1 cm farther from it, the one
  /// nearest to its origin. Does nothing while a particle is held. \return whether a particle is
  /// held now.
  bool pick(const Ray& ray, const State& state);
  /// Directs the held particle to the ray.
  /// \param time  now [s].
  void aim(const Ray& ray, double time);
  void release() { vertex_ = kNone; }
  VertexId vertex() const { return vertex_; }  ///< the held particle; kNone: none

  /// Moves the target by one step of `dt` [s].
  /// \param state  before the step.
  void advance(const State& state, double dt);
  void appendTargets(std::vector<KinematicTarget>& out) const;
  void applyChanges(const MeshChanges& changes);
  /// Shifts the time of the last aim by `by` [s], as the clock jumps.
  void shiftTime(double by) { aimed_ += by; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(vertex_, depth_, offset_, goal_, aimed_, position_, velocity_);
  }

 private:
  VertexId vertex_ = kNone;
  double depth_ = 0.0;            ///< along the ray [m]
  Vec3 offset_ = Vec3::Zero();    ///< from the ray to the particle when it was picked [m]
  Vec3 goal_ = Vec3::Zero();      ///< where the particle is to go [m]
  double aimed_ = 0.0;            ///< time of the last aim [s]
  Vec3 position_ = Vec3::Zero();  ///< of the target at the end of the step [m]
  Vec3 velocity_ = Vec3::Zero();  ///< of the target [m/s]
};

}  // namespace cloth_sim
