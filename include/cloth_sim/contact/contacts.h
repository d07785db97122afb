#pragma once
/// \file What a solver knows of obstacles: which particles are near them, and how to be pushed out.

#include <functional>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

class Collider;

/// A solver's particles as structure of arrays: where they are, where they were at the start of
/// the substep, and their masses. `slotOf` maps a vertex to its place in the arrays.
struct ParticleView {
  double* x = nullptr;
  double* y = nullptr;
  double* z = nullptr;
  const double* startX = nullptr;
  const double* startY = nullptr;
  const double* startZ = nullptr;
  /// [kg]; 0 marks a particle whose motion is prescribed: it is pushed out of obstacles, but feels
  /// no friction and gives no impulse.
  const double* mass = nullptr;
  const std::int32_t* slotOf = nullptr;  ///< by vertex; nullptr: the identity
};

/// The particles of one cloth that may touch one collider during one step.
struct ContactCandidates {
  const Collider* collider = nullptr;
  std::size_t cloth = 0;
  std::vector<VertexId> vertices;  ///< ascending
  /// Impulse that the cloth has given the collider since detection [N s].
  Vec3 impulse = Vec3::Zero();
};

/// How fast a particle that began a substep inside a collider is pushed out [m/s]. It bounds the
/// speed that a particle can gain where a collider appears inside the cloth or a clamp presses
/// cloth into one, and so keeps such a scene from exploding; deep overlaps take 1 s per metre to
/// resolve.
constexpr double kDepenetrationSpeed = 1.0;

/// Contacts of one step: detected once, enforced at every substep (as in Jolt's soft bodies).
class Contacts {
 public:
  /// Only colliders with a vertex to test are listed.
  std::vector<ContactCandidates> candidates;

  bool empty() const { return candidates.empty(); }

  /// Empties the list but keeps the memory, so that a step allocates nothing once warm.
  void clear();
  /// Appends an entry with no vertices and no impulse.
  ContactCandidates& add(const Collider* collider, std::size_t cloth = 0);
  /// Takes back the last entry.
  void dropLast();

  /// Divides every entry by cloth: what detection found of any goes to where it belongs. Allocates
  /// nothing once warm.
  void divide(std::size_t cloths, const std::function<std::size_t(VertexId)>& clothOf);

  /// Moves particles out of the colliders and applies friction, as displacements within one
  /// substep that ends at `time` [s] and lasted `h` [s], > 0. Non-penetration is inelastic; sliding
  /// is Coulomb's cone on displacements: it stops the slip up to mu times the normal push, so what
  /// should stick sticks exactly (Mueller et al. 2007; Macklin et al. 2014, eq. 24). The path from
  /// the start of the substep is swept in the frame of the moving collider, so a particle cannot
  /// pass through a collider thinner than it is fast. A particle that began inside leaves by the
  /// shortest way at `kDepenetrationSpeed` at most. Velocities follow from the displacements:
  /// v = (x - start) / h.
  void project(const ParticleView& particles, double time, double h);

 private:
  void keepMemoryOf(std::vector<VertexId>& vertices);

  std::vector<std::vector<VertexId>> spare_;  ///< memory of entries that are not listed now
  std::vector<ContactCandidates> whole_;      ///< for divide; empty otherwise
};

}  // namespace cloth_sim
