#pragma once
/// \file What can be asked of a running simulation, as values that can be queued, logged and
/// replayed.

#include <optional>
#include <string>
#include <variant>

#include "cloth_sim/clamp/clamp.h"
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

  template <class Archive>
  void serialize(Archive& archive) {
    archive(clamp, pose);
  }
};
/// As SetClampTarget, with a target that moves: what a robot's hand does.
struct GuideClamp {
  std::string clamp;
  MovingPose target;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(clamp, target);
  }
};
struct SetGripForce {
  std::string clamp;
  std::optional<double> force;  ///< > 0 [N]; absent: any

  template <class Archive>
  void serialize(Archive& archive) {
    archive(clamp, force);
  }
};
/// What a hand's width says: up to halfway between closed and open the clamp closes, beyond it lets
/// go.
struct SetGapWidth {
  std::string clamp;
  double width = 0.0;  ///< [m]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(clamp, width);
  }
};
/// A clamp more, until it is removed or the scene is reset.
struct CreateClamp {
  ClampSpec spec;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(spec);
  }
};
/// Lets go and takes the clamp away, until the scene is reset.
struct DeleteClamp {
  std::string clamp;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(clamp);
  }
};
struct SetGrasp {
  std::string clamp;
  bool grasp = true;  ///< true: close, false: release

  template <class Archive>
  void serialize(Archive& archive) {
    archive(clamp, grasp);
  }
};
struct SetPhase {
  std::string phase;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(phase);
  }
};
struct SetGravity {
  Vec3 gravity = Vec3::Zero();  ///< [m/s^2]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(gravity);
  }
};
struct MoveObstacle {
  std::string obstacle;
  Pose pose;
  Vec3 velocity = Vec3::Zero();  ///< [m/s]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(obstacle, pose, velocity);
  }
};
/// The obstacle goes along with a target that moves, and is where that is at the end of every step.
/// It goes there at once if that took more than kFastestObstacle. `velocity` of a phase or of
/// MoveObstacle ends it.
struct GuideObstacle {
  std::string obstacle;
  MovingPose target;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(obstacle, target);
  }
};
/// An obstacle that would have to be faster to reach its target jumps there [m/s].
constexpr double kFastestObstacle = 10.0;
struct SetTearing {
  bool enabled = false;
  TearRatios ratio{};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(enabled, ratio);
  }
};
struct SetWind {
  std::optional<Wind> wind;  ///< absent: none

  template <class Archive>
  void serialize(Archive& archive) {
    archive(wind);
  }
};
/// Makes the cloth stiffer or softer than the scene says, in all its springs and its bending alike.
struct SetStiffness {
  double scale = 1.0;  ///< times the scene's stiffness, 1e-3 ... 1e3 [-]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(scale);
  }
};
/// Pulls a particle along with a ray; the first one of a pull picks the particle. To be sent again
/// and again while the pull lasts: see `Drag::kPatience`.
struct PullParticle {
  bool held = true;  ///< false: let go (the ray does not matter)
  Ray ray;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(held, ray);
  }
};
/// Cuts along a stroke. Answers success and that nothing was cut if it misses.
struct CutAlong {
  Stroke stroke;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(stroke);
  }
};
enum class ResetScope : std::uint8_t {
  kBoth,   ///< back to the start of the scene, and of time
  kState,  ///< back to the start of the scene, while time and steps go on
  kTime,   ///< time and steps begin at zero again; the cloth, clamps and phases stay as they are
};
struct Reset {
  ResetScope scope = ResetScope::kBoth;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(scope);
  }
};
/// Goes on from a saved state (Simulation::save).
struct Restore {
  std::string bytes;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(bytes);
  }
};

using Command =
    std::variant<SetClampTarget, GuideClamp, SetGripForce, SetGapWidth, CreateClamp, DeleteClamp,
                 SetGrasp, SetPhase, SetGravity, MoveObstacle, GuideObstacle, SetTearing, SetWind,
                 SetStiffness, PullParticle, CutAlong, RefineNear, Reset, Restore>;

/// Whether a command makes the cloth another one, so that what was known of it is void.
inline bool beginsAnew(const Command& command) {
  if (const auto* reset = std::get_if<Reset>(&command)) return reset->scope != ResetScope::kTime;
  return std::holds_alternative<Restore>(command);
}

/// Whether a command was carried out, and if not, why, in one sentence.
struct CommandResult {
  bool success = false;
  std::string message;
};

}  // namespace cloth_sim
