#pragma once
/// \file Clamps: two parallel plates that grasp cloth. An input to a step: they say where the
/// particles they hold shall be, and never edit the state.

#include <optional>
#include <string>
#include <vector>

#include "cloth_sim/clamp/moving_pose.h"
#include "cloth_sim/cloth/state.h"
#include "cloth_sim/solver/solver.h"

namespace cloth_sim {

/// A square patch of grid particles, (2 radius + 1) x (2 radius + 1) around one (clipped at the
/// border of the grid), and whatever edits of the mesh have put between them.
struct ClampPatch {
  int column = 0;
  int row = 0;
  int radius = 3;         ///< [particles], >= 0
  std::size_t cloth = 0;  ///< which of the model's

  template <class Archive>
  void serialize(Archive& archive) {
    std::uint64_t number = cloth;
    archive(column, row, radius, number);
    cloth = number;
  }
};

/// What a scene says of a clamp. In the clamp's frame the plates are parallel to x and y, and
/// close along z.
struct ClampSpec {
  std::string name;
  Pose pose;                          ///< at the start
  Vec2 plateSize = Vec2(0.06, 0.06);  ///< along x and y [m], > 0
  double gapOpen = 0.12;              ///< between the plates [m], > gapClosed
  double gapClosed = 0.02;            ///< [m], > 0
  double closingSpeed = 0.2;          ///< of the gap [m/s], > 0
  double maxLinearSpeed = 0.5;        ///< [m/s], > 0
  double maxAngularSpeed = 2.0;       ///< [rad/s], > 0
  /// [m/s^2], > 0. The angular acceleration is limited to this over kClampArm.
  double maxLinearAcceleration = 10.0;
  /// The most that it can hold against, > 0 [N]; absent: any force. Where the cloth pulls harder,
  /// it slides through the plates.
  std::optional<double> gripForce;
  /// Particles to grasp, wherever they are; absent: whatever is between the plates.
  std::optional<ClampPatch> patch;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, pose, plateSize, gapOpen, gapClosed, closingSpeed);
    archive(maxLinearSpeed, maxAngularSpeed, maxLinearAcceleration, patch, gripForce);
  }
};

/// Lever by which a clamp's linear acceleration limit becomes an angular one: the size of a hand
/// [m].
constexpr double kClampArm = 0.1;

/// Force and torque about the clamp's origin, in the world's axes.
struct Wrench {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 torque = Vec3::Zero();  ///< [N m]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(force, torque);
  }
};

enum class ClampState { kOpen, kClosing, kClosed };
const char* toString(ClampState state);  ///< "open", "closing", "closed"

/// One clamp at work.
///
/// Motion: from rest it moves on the straight line to its target and turns about the axis of the
/// shortest arc, speeding up, cruising and braking within its limits, so that it arrives without
/// overshoot. The target may change at any time; the velocity then turns towards the new one within
/// the acceleration limit.
///
/// Grasp: while the gap closes, the plates take along what they meet: a particle between them is
/// held from the step in which one of them reaches it. When the gap has closed, what is left
/// between the plates is held too. Each held particle keeps its place in the clamp's frame, except
/// that its z is brought into the gap, at half the closing speed (that of one plate) at most, so
/// that nothing jumps. A patch is grasped likewise but wherever it is, also beside the plates; what
/// of it lies beyond a plate is held as soon as closing begins.
///
/// Slip: a grip of limited force holds as long as what it must bear, |the sum of the reactions|, is
/// within its limit. Beyond, all that it holds slides as one: the particles are free, and the grip
/// brakes them by exactly its limit, against their mean velocity relative to the clamp, each by
/// its share of their mass (dry friction of a patch). What leaves the region between the open
/// plates is let go. When the sliding turns round, the clamp tries to hold again. So the wrench of
/// a step never exceeds the limit.
///
/// Order of use in a step: `clearWrench`; then once, or for each of its equal parts: `advance`,
/// `appendTargets`, `appendForces`, (solver), `yield` (and, if that says so, the solver again),
/// `addReactions`. Call `applyChanges` after every edit of the mesh.
class Clamp {
 public:
  /// \throws std::invalid_argument unless every length, speed and acceleration is finite and > 0,
  ///         gapOpen > gapClosed, and the orientation can be normalised.
  explicit Clamp(ClampSpec spec);

  const ClampSpec& spec() const { return spec_; }
  const Pose& pose() const { return pose_; }
  const Pose& target() const { return target_.pose; }
  const Vec3& linearVelocity() const { return linearVelocity_; }
  const Vec3& angularVelocity() const { return angularVelocity_; }
  double gap() const { return gap_; }  ///< between the plates [m]
  ClampState state() const { return state_; }
  /// Particles held, ascending.
  const std::vector<VertexId>& held() const { return held_; }
  /// What the cloth does to the clamp: mean over the last step; zero if it holds nothing.
  const Wrench& wrench() const { return wrench_; }

  /// Commands a pose (finite, with a unit quaternion); the clamp goes there within its limits.
  void setTarget(const Pose& target) { target_ = {target, Vec3::Zero(), Vec3::Zero(), 0.0}; }
  /// Commands a pose that moves; the clamp goes along with it, without lag once it is there. Its
  /// velocities are limited to the clamp's own.
  void guide(const MovingPose& target);
  /// Changes the grip force, > 0 [N]; absent: any force.
  void setGripForce(std::optional<double> force) { spec_.gripForce = force; }
  /// Limits the linear speed further [m/s], > 0; absent: back to the spec's limit. A clamp that is
  /// faster brakes within its acceleration limit.
  void setSpeedLimit(std::optional<double> speed) { speedLimit_ = speed; }
  /// Puts the clamp at a pose at once. Only while it holds nothing.
  /// \throws std::logic_error if it holds cloth.
  void place(const Pose& pose);
  /// Where it would come to rest if it braked from now on.
  Pose stoppingPose() const;
  /// Whether the clamp stands still at its target (1e-6 m, 1e-6 rad, and that per second).
  bool atTarget() const;
  /// Whether the next steps leave it exactly as it is: it has arrived, opened or closed, and what
  /// it holds is neither squeezed nor slips.
  bool isStill() const;

  /// Starts closing. No effect while closing or closed.
  void close();
  /// Lets go at once and opens; the cloth keeps its velocity.
  void release();

  /// Moves pose and gap by one step and grasps what the plates meet. `state` is the one before the
  /// step.
  void advance(const Model& model, const State& state, double dt);

  /// Where the held particles shall be at the end of the step, ascending by vertex; none while
  /// they slip.
  void appendTargets(std::vector<KinematicTarget>& out) const;

  /// The friction on held particles that slip; none while they do not.
  void appendForces(const Model& model, std::vector<PointForce>& out) const;

  /// Whether the held particles slide through the plates.
  bool isSlipping() const { return slip_.on; }
  /// How far they have slid since they were grasped [m].
  double slipped() const { return slip_.distance; }

  /// If holding takes more than the grip force, lets the cloth slip. The step must then be solved
  /// again from its start.
  /// \param targets, reactions  as for `addReactions`, of a part of the step.
  bool yield(const std::vector<KinematicTarget>& targets, const std::vector<Vec3>& reactions);

  void clearWrench() { wrench_ = Wrench(); }

  /// Adds to the wrench `reactions[k]`, the force that the particle `targets[k]` puts on its
  /// holder, over what this clamp holds. Held particles that are not among the targets count as
  /// zero. While they slip: `addSlipWrench`.
  /// \param targets  ascending by vertex; of the step that the reactions are of.
  /// \param share  of the step that the reactions are the mean over.
  /// \throws std::invalid_argument if there are not as many reactions as targets.
  void addReactions(const std::vector<KinematicTarget>& targets, const std::vector<Vec3>& reactions,
                    double share = 1.0);
  /// Adds the friction of a clamp that slips to its wrench. `state` is the one after the step.
  void addSlipWrench(const Model& model, const State& state, double share = 1.0);

  /// Copies of held particles are held too, at the same place; so is a particle that an edit put
  /// between held ones. Held particles must not be moved within the surface.
  void applyChanges(const MeshChanges& changes);

 private:
  /// A particle in the clamp's grip.
  struct Grip {
    VertexId vertex = kNone;
    Vec3 local = Vec3::Zero();  ///< place in the clamp's frame [m]
    double squeeze = 0.0;       ///< rate of local z [m/s]

    template <class Archive>
    void serialize(Archive& archive) {
      archive(vertex, local, squeeze);
    }
  };

  friend class cereal::access;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(spec_, pose_, target_, linearVelocity_, angularVelocity_, speedLimit_);
    archive(gap_, state_, grips_, held_, wrench_, slip_, targetLinear_, targetAngular_);
  }

  /// How what is held slides.
  struct Slip {
    bool on = false;
    Vec3 direction = Vec3::Zero();  ///< unit vector, of the cloth relative to the clamp
    Vec3 box = Vec3::Zero();        ///< half the region beyond which the clamp lets go [m]
    double distance = 0.0;          ///< since the grasp [m]

    template <class Archive>
    void serialize(Archive& archive) {
      archive(on, direction, box, distance);
    }
  };

  void moveTarget(double dt);
  void movePose(double dt);
  void moveGap(double dt);
  void grasp(const Model& model, const State& state, double gapBefore, double dt);
  void graspPatch(const Model& model, const State& state);
  void graspRegion(const State& state, double gapBefore, double dt);
  void take(VertexId vertex, const Vec3& local);
  void squeeze(double dt);
  void slide(const Model& model, const State& state, double dt);
  Vec3 slidingVelocity(const Model& model, const State& state) const;
  double heldMass(const Model& model) const;
  const Grip* findGrip(VertexId vertex) const;
  void holdNew(const VertexEdit& edit);
  void replaceHeld(const VertexEdit& edit);
  void updateHeld();

  ClampSpec spec_;
  Pose pose_;
  MovingPose target_;
  Vec3 targetLinear_ = Vec3::Zero();   ///< velocity of the target in this step [m/s]
  Vec3 targetAngular_ = Vec3::Zero();  ///< [rad/s]
  Vec3 linearVelocity_ = Vec3::Zero();
  Vec3 angularVelocity_ = Vec3::Zero();
  std::optional<double> speedLimit_;
  double gap_ = 0.0;
  ClampState state_ = ClampState::kOpen;
  std::vector<Grip> grips_;     ///< ascending by vertex
  std::vector<VertexId> held_;  ///< the vertices of grips_
  Slip slip_;
  Wrench wrench_;
};

/// The particles of a patch, ascending.
/// \throws std::invalid_argument if the model is not a grid or the centre is outside of it.
std::vector<VertexId> patchParticles(const Model& model, const ClampPatch& patch);

}  // namespace cloth_sim
