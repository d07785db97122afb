#pragma once
/// \file What can be asked of a running simulation, as values that can be queued, logged and
/// replayed.

#include <string>
#include <variant>

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
/// Cuts along a stroke. Answers success and that nothing was cut if it misses.
struct CutAlong {
  Stroke stroke;
};
/// Back to the start of the scene.
struct Reset {};

using Command = std::variant<SetClampTarget, SetGrasp, SetPhase, SetGravity, MoveObstacle,
                             SetTearing, CutAlong, RefineNear, Reset>;

/// Whether a command was carried out, and if not, why, in one sentence.
struct CommandResult {
  bool success = false;
  std::string message;
};

}  // namespace cloth_sim
