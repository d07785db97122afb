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

  template <class Archive>
  void serialize(Archive& archive) {
    archive(clamp, pose);
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

using Command = std::variant<SetClampTarget, SetGrasp, SetPhase, SetGravity, MoveObstacle,
                             SetTearing, SetWind, SetStiffness, PullParticle, CutAlong, RefineNear, Reset, Restore>;

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
