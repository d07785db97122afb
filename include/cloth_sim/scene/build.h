#pragma once
/// \file From a scene to the parts of a simulation.

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

Model buildModel(const ClothSpec& spec);

/// The cloth where the scene drops it. `seed` decides the random offset.
State initialState(const ClothSpec& spec, const Model& model, std::uint64_t seed);

/// Where the pinned particles stay, ascending by vertex.
std::vector<KinematicTarget> pinTargets(const ClothSpec& spec, const Model& model,
                                        const State& state);

ColliderSet buildColliders(const Scene& scene);

}  // namespace cloth_sim
