#pragma once
/// \file The scenes in which errors are measured at the sizes that people run.

#include <string>
#include <vector>

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// A scene of a square cotton with the time that it runs.
struct Motion {
  std::string name;
  Scene scene;
  double duration = 0.0;    ///< [s]
  bool endsAtRest = false;  ///< whether the shape at the end is that of a cloth at rest
  bool tears = false;       ///< whether two clamps pull it apart, of which the first one is watched
};

/// Makes a motion with a number of particles per side.
using MotionMaker = Motion (*)(int particles);

/// A cloth pinned along its upper edge, released at 45 degrees, for 0.8 s.
Motion edgeSwing(int particles);
/// A cloth pinned at two corners, released horizontally, for 1.5 s.
Motion cornerHang(int particles);
/// A cloth that drops by 5 cm on a ball of radius 0.25 m and drapes over it, for 2 s, with a drag
/// of 4 /s, which brings it to rest.
Motion ballDrop(int particles);
/// A cloth that lies on a table with 40 % of its side beyond the edge, for 1 s.
Motion tableEdge(int particles);
/// A cloth that two clamps grasp by its corners, lift off the ground by 1.2 m and shake by 10 cm to
/// both sides, for 1.5 s, with a drag of 4 /s. (With less, it folds in ways that nothing predicts.)
Motion shakenTowel(int particles);
/// A notched cloth on a table without friction that two clamps pull apart along its middle seam, as
/// in the scene `tear_seam`: by the middles of two sides, at 0.2 m/s each, for 1.2 s.
Motion seamPull(int particles);

/// All of them.
const std::vector<MotionMaker>& motionMakers();

/// The energy that gravity releases when the cloth falls by half its side: the scale of errors [J].
double energyScale(const Motion& motion);

}  // namespace cloth_sim
