#pragma once
/// \file Builds the parts of a simulation from a scene.

#include "cloth_sim/contact/layers.h"
#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// Builds one model of all cloths. Its vertices are those of the first cloth, then those of the
/// second, and so on. Cloths share neither faces nor springs.
Model buildModel(const std::vector<ClothSpec>& cloths);
/// Builds the model of one cloth.
Model buildModel(const ClothSpec& cloth);

/// Returns the state in which the cloths start. \param seed  decides the random offsets.
State initialState(const std::vector<ClothSpec>& cloths, const Model& model, std::uint64_t seed);

/// Returns the targets of the pinned particles, ascending by vertex.
std::vector<KinematicTarget> pinTargets(const std::vector<ClothSpec>& cloths, const Model& model,
                                        const State& state);

/// Returns the obstacles of the scene with the contact properties of its cloths.
ColliderSet buildColliders(const Scene& scene);
/// Largest thickness that layers of cloth keep apart: half of the shortest edge at rest [m].
double thickestLayer(const Model& model);
/// Returns the contact between the layers of the scene's cloths, or null if it has none.
std::unique_ptr<LayerContact> buildLayers(const Scene& scene, const Model& model);

}  // namespace cloth_sim
