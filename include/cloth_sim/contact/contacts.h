#pragma once
/// \file The contacts of one step, as a solver uses them: candidate particles by collider, and
/// their projection out of the colliders.

#include <array>
#include <functional>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

class Collider;
class LayerContact;

/// Particles of a solver as structure of arrays. Each array is indexed by slot.
struct ParticleView {
  double* x = nullptr;  ///< positions [m]
  double* y = nullptr;
  double* z = nullptr;
  const double* startX = nullptr;  ///< positions at the start of the substep [m]
  const double* startY = nullptr;
  const double* startZ = nullptr;
  /// [kg]; 0 marks a particle with prescribed motion: colliders push it out, but it feels no
  /// friction and gives no impulse.
  const double* mass = nullptr;
  const std::int32_t* slotOf = nullptr;  ///< slot by vertex; nullptr: slot and vertex are the same

  std::int32_t slot(VertexId vertex) const { return slotOf != nullptr ? slotOf[vertex] : vertex; }
  Vec3 at(std::int32_t slot) const { return {x[slot], y[slot], z[slot]}; }
  Vec3 startAt(std::int32_t slot) const { return {startX[slot], startY[slot], startZ[slot]}; }
};

/// Linear and angular impulse of particles on a collider.
struct ContactImpulse {
  Vec3 linear = Vec3::Zero();   ///< [N s]
  Vec3 angular = Vec3::Zero();  ///< about the origin of the world [N m s]
};

/// A sharp corner of a mesh and a face of the cloth, or a sharp edge and an edge of the cloth, that
/// can meet during one step.
struct FeaturePair {
  std::int32_t feature = 0;         ///< of the collider
  std::array<VertexId, 3> cloth{};  ///< corners of the face; of an edge, its ends and kNone
  bool isPierced = false;           ///< whether they intersect at the start of the step
  bool isNear = false;              ///< whether they can meet in the present substep
  std::int8_t side = 0;             /**< of the cloth on which the feature is, if it stopped the
                                         cloth in the last substep: 1 or -1; else 0 */
};

/// The parts of one cloth that can touch one collider during one step.
struct ContactCandidates {
  const Collider* collider = nullptr;
  std::size_t cloth = 0;
  std::vector<VertexId> vertices;  ///< ascending
  std::vector<FeaturePair> pairs;  ///< of a mesh that has sharp corners or edges
  ContactImpulse impulse;          ///< that the cloth has given the collider since detection
};

/// Speed limit for pushing out a particle that starts a substep inside a collider [m/s]. It bounds
/// the energy that a scene gains where a collider appears inside the cloth, or where a clamp
/// presses cloth into one, and so keeps such a scene from exploding. The price: a deep overlap
/// takes 1 s per metre to resolve.
constexpr double kDepenetrationSpeed = 1.0;

/// Contacts of one step. Detection fills them once; each substep enforces them (as Jolt does for
/// soft bodies).
class Contacts {
 public:
  /// One entry for each pair of a cloth and a collider near it.
  std::vector<ContactCandidates> candidates;

  /// Contact between layers of cloth; null if the scene has none. Then any particle may be moved.
  LayerContact* layers = nullptr;

  bool empty() const { return candidates.empty() && layers == nullptr; }

  /// Empties the list but keeps its buffers, so that later steps allocate nothing.
  void clear();
  /// Appends an entry without vertices and without an impulse.
  ContactCandidates& add(const Collider* collider, std::size_t cloth = 0);
  /// Removes the last entry and keeps its buffer.
  void dropLast();

  /// Splits each entry of detection, which holds vertices of all cloths, into one entry per cloth.
  /// Allocates nothing once the buffers are large enough.
  /// \param clothOf  returns the cloth of a vertex, less than `cloths`.
  void splitByCloth(std::size_t cloths, const std::function<std::size_t(VertexId)>& clothOf);

  /// Moves layers of cloth apart and particles out of the colliders, with friction, as
  /// displacements at the end of a substep of `h` [s], > 0, that ends at `time` [s]; then shortens
  /// motions that would make faces intersect. The velocity follows as v = (x - start) / h.
  ///
  /// Non-penetration is inelastic. Friction is Coulomb's cone on displacements: it stops the slip
  /// up to mu times the normal push, so a particle within the cone sticks exactly (Mueller et al.
  /// 2007; Macklin et al. 2014, eq. 24). The path from the start of the substep is swept in the
  /// frame of the moving collider, so no particle passes through a thin collider, however fast. A
  /// particle that starts inside leaves by the shortest way, at most at `kDepenetrationSpeed`.
  void project(const ParticleView& particles, double time, double h);

 private:
  void projectObstacle(ContactCandidates& entry, const std::vector<VertexId>& vertices,
                       const ParticleView& particles, double time, double h);
  const std::vector<VertexId>& pushedOf(const ContactCandidates& entry);
  /// The arrays of an entry, without their contents.
  struct Buffers {
    std::vector<VertexId> vertices;
    std::vector<FeaturePair> pairs;
  };

  void keepBuffers(ContactCandidates& entry);

  std::vector<Buffers> spare_;              ///< for entries to come
  std::vector<VertexId> pushed_;            ///< scratch of pushedOf
  std::vector<ContactCandidates> unsplit_;  ///< scratch of splitByCloth; empty otherwise
};

}  // namespace cloth_sim
