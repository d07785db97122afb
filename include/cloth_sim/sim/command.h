#pragma once
/// \file What can be asked of a running simulation, as values that can be queued, logged and
/// replayed.

#include <string>
#include <variant>

#include "cloth_sim/clamp/clamp.h"
#include "cloth_sim/surgery/settings.h"
#include "cloth_sim/surgery/stroke.h"
#include "cloth_sim/surgery/tearing.h"
#include "cloth_sim/types.h"

namespace cloth_sim {

struct SetClampTarget {
  std::string clamp;
  Pose pose;
};
/// As SetClampTarget, with a target that moves: what a robot's hand does.
struct GuideClamp {
  std::string clamp;
  MovingPose target;
};
struct SetGripForce {
  std::string clamp;
  std::optional<double> force;  ///< > 0 [N]; absent: any
};
/// What a hand's width says: up to halfway between closed and open the clamp closes, beyond it lets
/// go.
struct SetGapWidth {
  std::string clamp;
  double width = 0.0;  ///< [m]
};
/// A clamp more, until it is removed or the scene is reset.
struct CreateClamp {
  ClampSpec spec;
};
/// Lets go and takes the clamp away, until the scene is reset.
struct DeleteClamp {
  std::string clamp;
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
/// The obstacle goes along with a target that moves, and is where that is at the end of every step.
/// It goes there at once if that took more than kFastestObstacle. `velocity` of a phase or of
/// MoveObstacle ends it.
struct GuideObstacle {
  std::string obstacle;
  MovingPose target;
};
/// An obstacle that would have to be faster to reach its target jumps there [m/s].
constexpr double kFastestObstacle = 10.0;
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

using Command = std::variant<SetClampTarget, GuideClamp, SetGripForce, SetGapWidth, CreateClamp,
                             DeleteClamp, SetGrasp, SetPhase, SetGravity, MoveObstacle,
                             GuideObstacle, SetTearing, CutAlong, RefineNear, Reset>;

/// Whether a command was carried out, and if not, why, in one sentence.
struct CommandResult {
  bool success = false;
  std::string message;
};

}  // namespace cloth_sim
