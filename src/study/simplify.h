#pragma once
/// \file Simplifications of a scene.

#include <functional>
#include <string>
#include <vector>

#include "cloth_sim/scene/scene.h"
#include "run.h"

namespace cloth_sim {

/// A change of a scene that might make it cheaper.
struct Simplification {
  std::string what;                    ///< description: "without wind"
  std::vector<std::string> overrides;  ///< of the scene, see loadScene; empty: see `obstacle`
  std::string obstacle;                ///< reason why it is impossible; "": it is possible
};

/// Loads the scene with overrides. \throws SceneError
using SceneLoader = std::function<Scene(const std::vector<std::string>& overrides)>;

/// Returns the scene with particles `factor` times as far apart. Pins and patches of clamps move to
/// the nearest particles; impossible if none is near, or if the scene counts particles or springs.
/// \param factor  > 1.
Simplification coarser(const Scene& scene, double factor);

/// Returns all simplifications of a scene, roughly by the cost that they save.
std::vector<Simplification> simplificationsOf(const Scene& scene);

/// Interpolates a trajectory of the grid `from` at the particles of the grid `to`, bilinearly in
/// material coordinates. Empty if the particles are not those of `from` (the cloth was cut).
Trajectory onGrid(const Trajectory& trajectory, const Grid& from, const Grid& to);

/// Returns the grid of a scene's cloth at the start.
Grid gridOf(const Scene& scene);

}  // namespace cloth_sim
