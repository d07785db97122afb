#pragma once
/// \file What a scene might do without.

#include <functional>
#include <string>
#include <vector>

#include "cloth_sim/scene/scene.h"
#include "run.h"

namespace cloth_sim {

/// A change of a scene that might make it cheaper.
struct Simplification {
  std::string what;                    ///< in words: "without wind"
  std::vector<std::string> overrides;  ///< of the scene, see loadScene; none: `obstacle` says why
  std::string obstacle;                ///< why it cannot be made; "": it can
};

/// The scene with some overrides. Throws SceneError.
using SceneLoader = std::function<Scene(const std::vector<std::string>& overrides)>;

/// The cloth with fewer particles, `factor` times as far apart: pins and patches of clamps go to
/// the nearest particles, if those are near. What counts particles or springs cannot be carried
/// over. \param factor  > 1.
Simplification coarser(const Scene& scene, double factor);

/// All that may be left out of a scene, of what it names: first what saves most.
std::vector<Simplification> simplificationsOf(const Scene& scene);

/// Positions of the particles of the grid `to` on the surface that particles of the grid `from`
/// span, by bilinear interpolation between the four around each in material coordinates. Empty if
/// the trajectory's particles are not those of `from` (it was cut).
Trajectory onGrid(const Trajectory& trajectory, const Grid& from, const Grid& to);

/// The particles of a scene's cloth at its start.
Grid gridOf(const Scene& scene);

}  // namespace cloth_sim
