#pragma once
/// \file Obstacles: shapes that may move, and the detection of particles near them.

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/contact/contacts.h"

namespace cloth_sim {

/// Everything below a plane through the collider's position; its z axis is the outward normal.
struct PlaneShape {
  template <class Archive>
  void serialize(Archive& /*archive*/) {}
};
/// A solid ball around the collider's position.
struct SphereShape {
  double radius = 0.1;  ///< [m], > 0

  template <class Archive>
  void serialize(Archive& archive) {
    archive(radius);
  }
};
/// All points nearer than the radius to a segment of the collider's z axis around its position: a
/// rod, a finger, a hanger.
struct CapsuleShape {
  double radius = 0.05;  ///< [m], > 0
  double length = 0.2;   ///< of the segment, between the middles of the round ends [m], > 0

  template <class Archive>
  void serialize(Archive& archive) {
    archive(radius, length);
  }
};
/// A solid board (table top): a box around the collider's position.
struct BoxShape {
  Vec3 size = Vec3::Ones();  ///< full edge lengths [m], > 0

  template <class Archive>
  void serialize(Archive& archive) {
    archive(size);
  }
};
/// The outside of a box around the collider's position is solid: particles stay within. Meant to be
/// much larger than the margin.
struct BoundsShape {
  Vec3 size = Vec3::Ones();  ///< full edge lengths [m], > 0

  template <class Archive>
  void serialize(Archive& archive) {
    archive(size);
  }
};
using Shape = std::variant<PlaneShape, SphereShape, CapsuleShape, BoxShape, BoundsShape>;

/// What a scene or a command says of an obstacle.
struct Obstacle {
  std::string name;
  Shape shape;
  Pose pose;
  Vec3 velocity =
      Vec3::Zero();  ///< of the pose's origin [m/s]; obstacles do not turn by themselves
  /// Coulomb coefficient [-], >= 0; absent: that of the cloth's fabric.
  std::optional<double> friction;
  /// Rate at which touching particles lose their tangential speed relative to the obstacle, besides
  /// friction [1/s], >= 0.
  double tangentialDecay = 0.0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, shape, pose, velocity, friction, tangentialDecay);
  }
};

/// What of a cloth decides how it meets obstacles.
struct ContactSkin {
  /// Distance that particles keep from a surface [m], >= 0: half the cloth's thickness. Edges of
  /// boards are rounded by it.
  double margin = 0.0;
  double friction = 0.3;  ///< Coulomb coefficient where the obstacle names none [-], >= 0

  template <class Archive>
  void serialize(Archive& archive) {
    archive(margin, friction);
  }
};

/// Where a cloth is, as an axis-aligned box, and how fast its fastest particle moves.
struct MotionBounds {
  Vec3 centre = Vec3::Zero();  ///< [m]
  Vec3 half = Vec3::Zero();    ///< half edge lengths [m]
  double speed = 0.0;          ///< [m/s]
};
/// Of all particles, in one pass; zero if there are none.
MotionBounds motionBounds(const State& state);

/// An obstacle at work: knows where it is at any time of the current step.
class Collider {
 public:
  /// \param skins  by cloth, at least one.
  /// \throws std::invalid_argument if a length is not positive, or a margin, a friction or the
  ///         decay is negative or not finite.
  Collider(Obstacle obstacle, std::vector<ContactSkin> skins);
  /// For one cloth.
  Collider(Obstacle obstacle, double margin)
      : Collider(std::move(obstacle), std::vector<ContactSkin>{{margin}}) {}

  const Obstacle& obstacle() const { return obstacle_; }
  /// The largest of any cloth [m].
  double margin() const;
  const std::vector<ContactSkin>& skins() const { return skins_; }
  /// Where it is at `time`, given where it was at `referenceTime` and its velocity.
  Pose poseAt(double time) const;
  /// Moves it: the pose holds at `time`, from where `velocity` goes on.
  void place(const Pose& pose, const Vec3& velocity, double time);
  /// It is where it would have been `by` earlier [s].
  void shiftTime(double by) { referenceTime_ += by; }

  /// Signed distance from `point` to the surface less the largest margin (negative inside) [m] at
  /// `time`.
  double gap(const Vec3& point, double time) const;
  /// The unit vector in which the gap at `point` grows fastest: away from the closest face, edge or
  /// corner.
  Vec3 normal(const Vec3& point, double time) const;

  /// Appends, ascending, the vertices that can touch it before `state.t + dt`, moving at most
  /// `reach` plus their speed relative to the collider times dt.
  void collect(const State& state, double dt, double reach, std::vector<VertexId>& out) const;

  /// See Contacts::project. Adds to `impulse` what the particles gave the collider [N s].
  /// \param cloth  that the vertices are of.
  void project(const std::vector<VertexId>& vertices, const ParticleView& particles, double time,
               double h, Vec3& impulse, std::size_t cloth = 0) const;

 private:
  friend class ColliderSet;
  friend class cereal::access;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(obstacle_, skins_, referenceTime_);
  }

  void collectWithin(const MotionBounds& bounds, const State& state, double dt, double reach,
                     std::vector<VertexId>& out) const;

  Obstacle obstacle_;
  std::vector<ContactSkin> skins_;  ///< by cloth
  double referenceTime_ = 0.0;
};

/// All obstacles of a scene.
class ColliderSet {
 public:
  void add(Obstacle obstacle, std::vector<ContactSkin> skins);
  void add(Obstacle obstacle, double margin) {
    add(std::move(obstacle), std::vector<ContactSkin>{{margin}});
  }
  std::vector<Collider>& all() { return colliders_; }
  const std::vector<Collider>& all() const { return colliders_; }
  /// nullptr if there is none of that name.
  Collider* find(const std::string& name);
  const Collider* find(const std::string& name) const;

  /// Candidates, of any cloth, of the step from state.t to state.t + dt. Colliders that nothing can
  /// reach cost a bounding-box test and appear in no loop. Allocates nothing once `out` is warm.
  /// \param reach  how far a particle may be pulled beyond its own speed times dt [m].
  /// \param bounds  of the state.
  void detect(const State& state, const MotionBounds& bounds, double dt, double reach,
              Contacts& out) const;
  void detect(const State& state, double dt, double reach, Contacts& out) const {
    detect(state, motionBounds(state), dt, reach, out);
  }

 private:
  std::vector<Collider> colliders_;
};

}  // namespace cloth_sim
