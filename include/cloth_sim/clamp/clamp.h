#pragma once
/// \file Clamps: two parallel plates that grasp cloth. An input to a step: they say where the
/// particles they hold shall be, and never edit the state.

#include <string>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/solver/solver.h"

namespace cloth_sim {

/// A square patch of grid particles, (2 radius + 1) x (2 radius + 1) around one (clipped at the
/// border of the grid).
struct ClampPatch {
  int column = 0;
  int row = 0;
  int radius = 3;  ///< [particles], >= 0
};

/// What a scene says of a clamp. In the clamp's frame the plates are parallel to x and y, and
/// close along z.
struct ClampSpec {
  std::string name;
  Pose pose;                                ///< at the start
  Vec2 plateSize = Vec2(0.06, 0.06);        ///< along x and y [m], > 0
  double gapOpen = 0.12;                    ///< between the plates [m], > gapClosed
  double gapClosed = 0.02;                  ///< [m], > 0
  double closingSpeed = 0.2;                ///< of the gap [m/s], > 0
  double maxLinearSpeed = 0.5;              ///< [m/s], > 0
  double maxAngularSpeed = 2.0;             ///< [rad/s], > 0
  double maxLinearAcceleration = 10.0;      ///< [m/s^2], > 0
  /// Particles to grasp; absent: whatever is between the plates when they have closed.
  std::optional<ClampPatch> patch;
};

/// Force and torque about the clamp's origin, in the world's axes.
struct Wrench {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 torque = Vec3::Zero();  ///< [N m]
};

enum class ClampState { kOpen, kClosing, kClosed };
const char* toString(ClampState state);  ///< "open", "closing", "closed"

/// One clamp at work.
///
/// Order of use in a step of length dt: `advance`, `appendTargets`, (solver), `readReactions`;
/// `follow` after every edit of the mesh.
class Clamp {
 public:
  explicit Clamp(ClampSpec spec);

  const ClampSpec& spec() const { return spec_; }
  const Pose& pose() const { return pose_; }
  const Pose& target() const { return target_; }
  const Vec3& linearVelocity() const { return linearVelocity_; }
  const Vec3& angularVelocity() const { return angularVelocity_; }
  double gap() const { return gap_; }  ///< between the plates [m]
  ClampState state() const { return state_; }
  /// Particles held, ascending.
  const std::vector<VertexId>& held() const { return held_; }
  /// What the cloth does to the clamp: mean over the last step; zero if it holds nothing.
  const Wrench& wrench() const { return wrench_; }

  /// Commands a pose; the clamp goes there within its limits.
  void setTarget(const Pose& target) { target_ = target; }
  /// Puts the clamp at a pose at once. Only while it holds nothing.
  /// \throws std::logic_error if it holds cloth.
  void place(const Pose& pose);
  /// Whether the clamp stands at its target (1e-6 m, 1e-6 rad).
  bool atTarget() const;

  /// Starts closing; what is inside is grasped when the plates meet the closed gap. No effect
  /// while closing or closed.
  void close();
  /// Lets go at once and opens; the cloth keeps its velocity.
  void release();

  /// Moves pose and gap by one step. Grasps when the gap has closed: each particle keeps its place
  /// in the clamp's frame, flattened along z so that it lies between the plates.
  void advance(const Model& model, const State& state, double dt);

  /// Where the held particles shall be at the end of the step (any order).
  void appendTargets(std::vector<KinematicTarget>& out) const;

  /// Sums `reactions[k]`, the force on the particle `targets[k]`, over what this clamp holds.
  void readReactions(const std::vector<KinematicTarget>& targets,
                     const std::vector<Vec3>& reactions);

  /// Copies of held particles are held too.
  void follow(const MeshChanges& changes);

 private:

  void grasp(const Model& model, const State& state);

  ClampSpec spec_;
  Pose pose_;
  Pose target_;
  Vec3 linearVelocity_ = Vec3::Zero();
  Vec3 angularVelocity_ = Vec3::Zero();
  double gap_ = 0.0;
  ClampState state_ = ClampState::kOpen;
  std::vector<VertexId> held_;
  std::vector<Vec3> local_;  ///< of held_, in the clamp's frame
  Wrench wrench_;
};

/// The particles of a patch, ascending.
/// \throws std::invalid_argument if the model is not a grid or the centre is outside of it.
std::vector<VertexId> patchParticles(const Model& model, const ClampPatch& patch);

}  // namespace cloth_sim
