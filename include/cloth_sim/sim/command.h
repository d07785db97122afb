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
                             SetTearing, CutAlong, RefineNear, Reset, Restore>;

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
