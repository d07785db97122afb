#pragma once
/// \file From a scene to the parts of a simulation.

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// All cloths as one model: its vertices are those of the first, then those of the second, and so
/// on; they share no face, and no spring.
Model buildModel(const std::vector<ClothSpec>& cloths);
/// Of one cloth.
Model buildModel(const ClothSpec& cloth);

/// The cloths where the scene drops them. `seed` decides the random offsets.
State initialState(const std::vector<ClothSpec>& cloths, const Model& model, std::uint64_t seed);

/// Where the pinned particles stay, ascending by vertex.
std::vector<KinematicTarget> pinTargets(const std::vector<ClothSpec>& cloths, const Model& model,
                                        const State& state);

ColliderSet buildColliders(const Scene& scene);

}  // namespace cloth_sim
