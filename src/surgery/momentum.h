#pragma once
/// \file Keeping momentum over an edit.

#include "cloth_sim/cloth/state.h"

namespace cloth_sim {

/// Linear and angular momentum of some particles.
struct Momentum {
  Vec3 linear = Vec3::Zero();   ///< [kg m/s]
  Vec3 angular = Vec3::Zero();  ///< about the world's origin [kg m^2/s]
};

/// Of those `vertices` that the masses know (an edit of the mesh may have made others already).
Momentum momentumOf(const std::vector<VertexId>& vertices, const VertexData<double>& mass,
                    const State& state);

/// Adds to the velocities of `vertices` the rigid motion that gives them the momentum `wanted`.
void restoreMomentum(const Momentum& wanted, const std::vector<VertexId>& vertices,
                     const VertexData<double>& mass, State& state);

}  // namespace cloth_sim
