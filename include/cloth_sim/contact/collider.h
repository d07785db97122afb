#pragma once
/// \file Colliders: obstacles in motion, and the detection of particles near them.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/contact/contacts.h"
#include "cloth_sim/contact/obstacle.h"

namespace cloth_sim {

class SharpFeatures;
class TriangleMesh;
struct ColliderSubstep;
struct PlacedFeatures;

/// Properties of a cloth that decide its contact with obstacles.
struct ContactProperties {
  /// Distance that particles keep from a surface [m], >= 0: half the thickness of the cloth. It
  /// rounds the edges of boxes.
  double margin = 0.0;
  double friction = 0.3;  ///< Coulomb coefficient where the obstacle names none [-], >= 0

  template <class Archive>
  void serialize(Archive& archive) {
    archive(margin, friction);
  }
};

/// Axis-aligned bounding box of all particles, and the speed of the fastest one.
struct MotionBounds {
  Vec3 centre = Vec3::Zero();  ///< [m]
  Vec3 half = Vec3::Zero();    ///< half edge lengths [m]
  double speed = 0.0;          ///< [m/s]
};
/// Computes the bounds in one pass; zero without particles.
MotionBounds motionBounds(const State& state);

/// An obstacle in a simulation: it has a pose at each time of the current step.
class Collider {
 public:
  /// \param properties  by cloth, at least one.
  /// \throws std::invalid_argument if a dimension is not positive, or if a margin, a friction
  ///         coefficient or the decay is negative or not finite.
  Collider(Obstacle obstacle, std::vector<ContactProperties> properties);
  /// A collider for one cloth with the default friction. \param margin  [m], >= 0.
  Collider(Obstacle obstacle, double margin)
      : Collider(std::move(obstacle), std::vector<ContactProperties>{{margin}}) {}

  const Obstacle& obstacle() const { return obstacle_; }
  /// The largest margin of all cloths [m].
  double margin() const;
  /// Contact properties by cloth.
  const std::vector<ContactProperties>& properties() const { return properties_; }
  /// Coulomb coefficient for a cloth [-]: the obstacle's own, else the cloth's.
  double friction(std::size_t cloth) const {
    return obstacle_.friction.value_or(properties_[cloth].friction);
  }
  /// The pose at `time` [s], extrapolated with the velocities from the last `place`.
  Pose poseAt(double time) const;
  /// Sets the pose that holds at `time` [s], and the velocities with which it changes from there.
  /// \param angularVelocity  in the axes of the world [rad/s].
  void place(const Pose& pose, const Vec3& velocity, double time,
             const Vec3& angularVelocity = Vec3::Zero());
  /// Tells whether it turns.
  bool turns() const { return !obstacle_.angularVelocity.isZero(0.0); }
  /// Takes the shape of a collider that has the same one: that of a saved state has no triangles.
  void shareShape(const Collider& other) {
    obstacle_.shape = other.obstacle_.shape;
    sharpSurface_ = other.sharpSurface_;
    features_ = other.features_;
  }
  /// Moves the time at which the stored pose holds `by` [s] later.
  void shiftTime(double by) { referenceTime_ += by; }

  /// Signed distance from `point` to the surface less the largest margin [m] at `time` [s];
  /// negative inside.
  double gap(const Vec3& point, double time) const;
  /// Unit vector in which the gap at `point` grows fastest: away from the nearest face, edge or
  /// corner.
  Vec3 normal(const Vec3& point, double time) const;

  /// Appends, in ascending order, the vertices that can touch the collider before `state.t + dt`.
  /// \param reach  distance that a vertex may move beyond its relative speed times dt [m].
  void collect(const State& state, double dt, double reach, std::vector<VertexId>& out) const;

  /// Tells whether the collider stops a particle of positive mass on its path, from the start to
  /// the end of a substep of `h` [s] that ends at `time` [s].
  bool stops(const std::vector<VertexId>& vertices, const ParticleView& particles, double time,
             double h, std::size_t cloth = 0) const;
  /// Moves particles out of the collider; see Contacts::project. Adds the impulse that the
  /// particles give the collider to `impulse`.
  /// \param cloth  the cloth that all of the vertices belong to.
  void project(const std::vector<VertexId>& vertices, const ParticleView& particles, double time,
               double h, ContactImpulse& impulse, std::size_t cloth = 0) const;
  /// The same for faces and edges of a cloth that meet sharp corners and edges.
  void projectFeatures(std::vector<FeaturePair>& pairs, const ParticleView& particles, double time,
                       double h, ContactImpulse& impulse, std::size_t cloth) const;
  /// Lets particles of faces and edges that would still pass through sharp corners and edges move
  /// along with the collider.
  void certifyFeatures(std::vector<FeaturePair>& pairs, const ParticleView& particles, double time,
                       double h, ContactImpulse& impulse) const;

 private:
  friend class ColliderSet;
  friend class cereal::access;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(obstacle_, properties_, referenceTime_);
  }

  /// Returns the triangles near each vertex up to `count`; nullptr if the shape has none.
  NearTriangles* nearTriangles(std::size_t count) const;
  PlacedFeatures placedFeatures(const Pose& pose) const;
  /// The motion during a substep of `h` [s] that ends at `time` [s].
  ColliderSubstep substep(double time, double h, std::size_t cloth) const;
  void collectWithin(const MotionBounds& bounds, const State& state, double dt, double reach,
                     std::vector<VertexId>& out) const;
  void collectFeatures(const TriangleMesh& mesh, const State& state, double dt, double reach,
                       std::vector<FeaturePair>& out) const;

  Obstacle obstacle_;
  std::vector<ContactProperties> properties_;  ///< by cloth
  double referenceTime_ = 0.0;                 ///< time at which the pose of the obstacle holds [s]
  /// By vertex, if the shape is a mesh. Each is used for the motion of its vertex only.
  mutable std::vector<NearTriangles> near_;
  std::shared_ptr<const TriangleSurface> sharpSurface_;  ///< null if only particles meet the shape
  std::shared_ptr<const SharpFeatures> features_;        ///< of it; null if it has none
  mutable std::vector<std::int32_t> found_;              ///< scratch of the search for features
};

/// All obstacles of a scene.
class ColliderSet {
 public:
  /// \param properties  by cloth, at least one. \throws std::invalid_argument as Collider does.
  void add(Obstacle obstacle, std::vector<ContactProperties> properties);
  /// Adds a collider for one cloth. \param margin  [m], >= 0.
  void add(Obstacle obstacle, double margin) {
    add(std::move(obstacle), std::vector<ContactProperties>{{margin}});
  }
  std::vector<Collider>& all() { return colliders_; }
  const std::vector<Collider>& all() const { return colliders_; }
  /// The collider of that name, or nullptr.
  Collider* find(const std::string& name);
  const Collider* find(const std::string& name) const;

  /// Finds the parts of all cloths that can touch a collider between state.t and state.t + dt. A
  /// collider out of reach costs a test of bounding boxes and gets no entry. Allocates nothing once
  /// the buffers of `out` are large enough.
  /// \param bounds  of the state.
  /// \param reach   distance that a vertex may move beyond its speed times dt [m].
  /// \param mesh    of the cloths: its faces and edges meet sharp corners and edges of meshes.
  void detect(const State& state, const MotionBounds& bounds, double dt, double reach,
              const TriangleMesh& mesh, Contacts& out) const;
  /// The same for particles without faces.
  void detect(const State& state, double dt, double reach, Contacts& out) const;

 private:
  std::vector<Collider> colliders_;
};

}  // namespace cloth_sim
