#pragma once
/// \file A pull at one particle, as with a mouse. An input to a step, like a clamp.

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

/// Why a ray cannot be used, in one sentence; empty if it can.
std::string validationError(const Ray& ray);

/// Holds a particle where a ray is, at the distance from the ray's origin that it was picked at. It
/// follows the ray with a time constant of 50 ms and at 1.5 m/s at most, as a kinematic target.
///
/// It lets go by itself when it has not been aimed for `kPatience` of simulated time: whoever
/// pulls may vanish.
class Drag {
 public:
  /// [s]
  static constexpr double kPatience = 1.0;
  /// How near to the ray a particle must be to be picked [m].
  static constexpr double kReach = 0.05;

  /// Takes hold of the particle that is nearest to the ray (of several within 1 cm of that, the one
  /// nearest to its origin); nothing happens while one is held.
  /// \return whether a particle is held now.
  bool pick(const Ray& ray, const State& state);
  /// Where the held particle shall go.
  /// \param time  now [s].
  void aim(const Ray& ray, double time);
  void release() { vertex_ = kNone; }
  VertexId vertex() const { return vertex_; }  ///< kNone: nothing is held

  /// Moves the target by one step. `state` is the one before it.
  void advance(const State& state, double dt);
  void appendTargets(std::vector<KinematicTarget>& out) const;
  void applyChanges(const MeshChanges& changes);
  /// Goes on as if it had been aimed `by` later [s].
  void shiftTime(double by) { aimed_ += by; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(vertex_, depth_, offset_, goal_, aimed_, position_, velocity_);
  }

 private:
  VertexId vertex_ = kNone;
  double depth_ = 0.0;            ///< along the ray [m]
  Vec3 offset_ = Vec3::Zero();    ///< of the particle from the ray when it was picked [m]
  Vec3 goal_ = Vec3::Zero();      ///< where it shall go [m]
  double aimed_ = 0.0;            ///< when it was aimed last [s]
  Vec3 position_ = Vec3::Zero();  ///< at the end of the step [m]
  Vec3 velocity_ = Vec3::Zero();  ///< [m/s]
};

}  // namespace cloth_sim
