#pragma once
/// \file Scenes with another number of particles.

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

// Bounds on the grids of a scene [particles].
constexpr int kFewestOnSide = 2;
constexpr int kMostOnSide = 2048;
constexpr int kMostInGrids = 1100000;  ///< of all cloths together

/// Returns a scene with `columns` particles along u of its first cloth, and all other sides of all
/// cloths in proportion. Pins and patches of clamps, which a scene names by particle, are at the
/// same place of the cloth, to the nearest particle: sides and blocks of pins stay whole, and
/// patches as wide. All else is as the scene says, also what it says per particle (raw springs,
/// masses) and the substeps that were chosen for it. Counts are in proportion to those of the scene
/// as it was loaded, whatever it has had since.
/// \param columns  0: the scene as it was loaded.
/// \throws std::invalid_argument with one sentence, if a number is out of bounds or a cloth is from
///         a file.
Scene withColumns(const Scene& scene, int columns);

/// Returns the numbers of particles of all cloths: "33 x 33" or "61 x 61, 33 x 49".
std::string gridsText(const Scene& scene);

}  // namespace cloth_sim
