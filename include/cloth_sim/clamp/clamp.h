#pragma once
/// \file Clamps: two parallel plates that grasp cloth. A clamp is an input to a step: it prescribes
/// the motion of the particles that it holds, and never edits the state.

#include <optional>
#include <string>
#include <vector>

#include "cloth_sim/clamp/moving_pose.h"
#include "cloth_sim/cloth/state.h"
#include "cloth_sim/solver/solver.h"

namespace cloth_sim {

/// A square patch of (2 radius + 1) x (2 radius + 1) grid particles around one of them, clipped at
/// the border of the grid, and the particles that edits of the mesh have added between them.
struct ClampPatch {
  int column = 0;
  int row = 0;
  int radius = 3;         ///< [particles], >= 0
  std::size_t cloth = 0;  ///< index of the cloth in the model

  template <class Archive>
  void serialize(Archive& archive) {
    std::uint64_t number = cloth;
    archive(column, row, radius, number);
    cloth = number;
  }
};

/// Specification of a clamp, as a scene gives it. In the clamp's frame the plates are parallel to
/// the x-y plane and close along z.
struct ClampSpec {
  std::string name;
  Pose pose;                          ///< at the start
  Vec2 plateSize = Vec2(0.06, 0.06);  ///< along x and y [m], > 0
  double gapOpen = 0.12;              ///< between the plates [m], > gapClosed
  double gapClosed = 0.02;            ///< [m], > 0
  double closingSpeed = 0.2;          ///< of the gap [m/s], > 0
  double maxLinearSpeed = 0.5;        ///< [m/s], > 0
  double maxAngularSpeed = 2.0;       ///< [rad/s], > 0
  /// Limit on the linear acceleration [m/s^2], > 0; that on the angular one is this over kClampArm.
  double maxLinearAcceleration = 10.0;
  /// Largest force that the grip can bear, > 0 [N]; absent: no limit. Cloth that pulls harder
  /// slides through the plates.
  std::optional<double> gripForce;
  /// Particles to grasp, wherever they are; absent: all particles between the plates.
  std::optional<ClampPatch> patch;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, pose, plateSize, gapOpen, gapClosed, closingSpeed);
    archive(maxLinearSpeed, maxAngularSpeed, maxLinearAcceleration, patch, gripForce);
  }
};

/// Lever arm by which the limit on the linear acceleration becomes one on the angular acceleration
/// [m]: the size of a hand.
constexpr double kClampArm = 0.1;

/// Force and torque about the origin of the clamp, in the axes of the world.
struct Wrench {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 torque = Vec3::Zero();  ///< [N m]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(force, torque);
  }
};

/// Motion of held particles that are beyond a plate, while it closes.
enum class Squeeze {
  kEach,     ///< each comes to lie in the plane of the plate
  kTogether  ///< all held particles move towards the middle by one factor, so that layers that
             ///< touch each other keep their order
};

enum class ClampState { kOpen, kClosing, kClosed };
const char* toString(ClampState state);  ///< "open", "closing", "closed"

/// A clamp in a simulation.
///
/// Motion: from rest, the clamp moves on the straight line to its target and turns about the axis
/// of the shortest arc. It accelerates, cruises and brakes within its limits, and arrives without
/// overshoot. The target may change at any time; the velocity then turns towards the new target
/// within the limit on the acceleration.
///
/// Grasp: while the gap closes, the plates take along the particles that they meet: a particle
/// between them is held from the step in which one of them reaches it. When the gap has closed, all
/// particles left between the plates are held too. A held particle keeps its place in the clamp's
/// frame, except that its z is brought into the gap (`Squeeze`), at most at half the closing speed
/// (that of one plate), so that nothing jumps. A patch is grasped in the same way, but wherever it
/// is, also beside the plates; its particles beyond a plate are held as soon as closing begins.
///
/// Slip: a grip of limited force holds as long as the norm of the sum of the reactions is within
/// its limit. Beyond it, all held particles slide together: they are free, and the grip brakes them
/// with exactly its limit, against their mean velocity relative to the clamp, each in proportion to
/// its mass (dry friction of a patch). Particles that leave the region between the open plates are
/// let go. When the direction of sliding reverses, the clamp tries to hold again. So the force of a
/// step never exceeds the limit.
///
/// Order of use in a step: `clearWrench` and `advance`; then, once or for each part of the step:
/// `appendTargets`, `appendForces`, (solver), `yield` (if it returns true, the solver again),
/// `addReactions`, `addSlipWrench`. `applyChanges` after every edit of the mesh.
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
  /// The held particles, ascending.
  const std::vector<VertexId>& held() const { return held_; }
  /// The wrench of the cloth on the clamp, mean over the last step; zero if it holds nothing.
  const Wrench& wrench() const { return wrench_; }

  /// Sends the clamp to a pose (finite, with a unit quaternion), within its limits.
  void setTarget(const Pose& target) { target_ = {target, Vec3::Zero(), Vec3::Zero(), 0.0}; }
  /// Sends the clamp along with a moving pose, without delay once it has caught up. The velocities
  /// of the target are cut to the limits of the clamp.
  void guide(const MovingPose& target);
  /// Sets the largest force of the grip, > 0 [N]; absent: no limit.
  void setGripForce(std::optional<double> force) { spec_.gripForce = force; }
  /// Limits the linear speed further [m/s], > 0; absent: only the limit of the specification holds.
  /// A clamp that is faster brakes within its limit on the acceleration.
  void setSpeedLimit(std::optional<double> speed) { speedLimit_ = speed; }
  /// Puts the clamp at a pose at once, while it holds nothing.
  /// \throws std::logic_error if it holds cloth.
  void place(const Pose& pose);
  /// Returns the pose at which it would come to rest if it braked from now on.
  Pose stoppingPose() const;
  /// Tells whether the clamp stands still at its target (1e-6 m, 1e-6 rad, and that per second).
  bool atTarget() const;
  /// Tells whether the next steps leave it exactly as it is: it has arrived, and opened or closed,
  /// and the held particles are neither squeezed nor slip.
  bool isStill() const;

  /// Starts closing. No effect while closing or closed.
  void close();
  /// Lets go at once and opens; the cloth keeps its velocity.
  void release();

  /// Moves pose and gap by one step of `dt` [s], and grasps the particles that the plates meet.
  /// \param state  before the step.
  /// \param how    held particles are brought between the plates.
  void advance(const Model& model, const State& state, double dt, Squeeze how = Squeeze::kEach);

  /// Stops the clamp, and takes back of its motion in the last step what its held particles could
  /// not follow: layers of cloth were in their way.
  /// \param state  after the step of `dt` [s].
  void holdBack(const State& state, double dt);

  /// Appends where the held particles are to be at the end of the step, ascending by vertex;
  /// nothing while they slip.
  void appendTargets(std::vector<KinematicTarget>& out) const;

  /// Appends the friction on the held particles while they slip.
  void appendForces(const Model& model, std::vector<PointForce>& out) const;

  /// Tells whether the held particles slide through the plates.
  bool isSlipping() const { return slip_.on; }
  /// Distance that the held particles have slid since they were grasped [m].
  double slipped() const { return slip_.distance; }

  /// Lets the cloth slip if holding it takes more than the grip force.
  /// \param targets, reactions  as for `addReactions`.
  /// \return whether it slips from now on: the step must then be solved again from its start.
  bool yield(const std::vector<KinematicTarget>& targets, const std::vector<Vec3>& reactions);

  void clearWrench() { wrench_ = Wrench(); }

  /// Adds the reactions of the held particles to the wrench. Held particles that are not among the
  /// targets count as zero. Does nothing while they slip: see `addSlipWrench`.
  /// \param targets    of the step, ascending by vertex.
  /// \param reactions  force of the particle `targets[k].vertex` on its holder [N], for each k.
  /// \param fraction   of the step that the reactions are the mean over, in (0, 1].
  /// \throws std::invalid_argument if there are not as many reactions as targets.
  void addReactions(const std::vector<KinematicTarget>& targets, const std::vector<Vec3>& reactions,
                    double fraction = 1.0);
  /// Adds the friction to the wrench while the held particles slip.
  /// \param state  after the step.
  void addSlipWrench(const Model& model, const State& state, double fraction = 1.0);

  /// Updates the held particles for an edit of the mesh: copies of held particles are held too, at
  /// the same place, and so are particles that the edit put between held ones. The edit must not
  /// move held particles within the surface.
  void applyChanges(const MeshChanges& changes);

  /// Checks what was read from a file, except for the specification.
  /// \param vertices  number of vertices of the cloth.
  /// \return one sentence about the first error; empty if there is none.
  std::string validationError(std::int32_t vertices) const;

 private:
  /// A held particle.
  struct Grip {
    VertexId vertex = kNone;
    Vec3 local = Vec3::Zero();  ///< place in the clamp's frame [m]
    double squeeze = 0.0;       ///< rate of change of local z [m/s]

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

  /// State of the sliding of the held particles.
  struct Slip {
    bool on = false;
    Vec3 direction = Vec3::Zero();  ///< unit vector, of the cloth relative to the clamp
    Vec3 box = Vec3::Zero();        ///< half size of the region in which particles stay held [m]
    double distance = 0.0;          ///< slid since the grasp [m]

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
  void squeeze(Squeeze how, double dt);
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
  Vec3 targetAngular_ = Vec3::Zero();  ///< its angular velocity [rad/s]
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

/// Returns the particles of a patch, ascending.
/// \throws std::invalid_argument if the cloth is not a grid, or the centre is outside of it.
std::vector<VertexId> patchParticles(const Model& model, const ClampPatch& patch);

}  // namespace cloth_sim
