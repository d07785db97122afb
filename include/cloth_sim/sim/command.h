#pragma once
/// \file What can be asked of a running simulation, as values that can be queued, logged and
/// replayed.

#include <optional>
#include <string>
#include <variant>

#include "cloth_sim/clamp/drag.h"
#include "cloth_sim/solver/solver.h"
#include "cloth_sim/surgery/settings.h"
#include "cloth_sim/surgery/stroke.h"
#include "cloth_sim/surgery/tearing.h"
#include "cloth_sim/types.h"

namespace cloth_sim {

struct SetClampTarget {
  std::string clamp;
  Pose pose;
};
struct SetGrasp {
  std::string clamp;
  bool grasp = true;  ///< true: close, false: release
};
struct SetPhase {
  std::string phase;
};
struct SetGravity {
  Vec3 gravity = Vec3::Zero();  ///< [m/s^2]
};
struct MoveObstacle {
  std::string obstacle;
  Pose pose;
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
};
struct SetTearing {
  bool enabled = false;
  TearRatios ratio{};
};
struct SetWind {
  std::optional<Wind> wind;  ///< absent: none
};
/// Makes the cloth stiffer or softer than the scene says, in all its springs and its bending alike.
struct SetStiffness {
  double scale = 1.0;  ///< times the scene's stiffness, 1e-3 ... 1e3 [-]
};
/// Pulls a particle along with a ray; the first one of a pull picks the particle. To be sent again
/// and again while the pull lasts: see `Drag::kPatience`.
struct PullParticle {
  bool held = true;  ///< false: let go (the ray does not matter)
  Ray ray;
};
/// Cuts along a stroke. Answers success and that nothing was cut if it misses.
struct CutAlong {
  Stroke stroke;
};
/// Back to the start of the scene.
struct Reset {};

using Command =
    std::variant<SetClampTarget, SetGrasp, SetPhase, SetGravity, MoveObstacle, SetTearing, SetWind,
                 SetStiffness, PullParticle, CutAlong, RefineNear, Reset>;

/// Whether a command was carried out, and if not, why, in one sentence.
struct CommandResult {
  bool success = false;
  std::string message;
};

}  // namespace cloth_sim
