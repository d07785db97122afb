#pragma once
/// \file Conservation of momentum in an edit.

#include "cloth_sim/cloth/state.h"

namespace cloth_sim {

/// Linear and angular momentum of a set of particles.
struct Momentum {
  Vec3 linear = Vec3::Zero();   ///< [kg m/s]
  Vec3 angular = Vec3::Zero();  ///< about the origin of the world [kg m^2/s]
};

/// Returns the momentum of `vertices`. Vertices without a mass are skipped: those that an edit of
/// the mesh has created, before masses and state are updated.
Momentum momentumOf(const std::vector<VertexId>& vertices, const VertexData<double>& mass,
                    const State& state);

/// Adds the velocities of a rigid motion to `vertices` such that their momentum becomes `wanted`.
void restoreMomentum(const Momentum& wanted, const std::vector<VertexId>& vertices,
                     const VertexData<double>& mass, State& state);

}  // namespace cloth_sim
