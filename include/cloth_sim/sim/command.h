#pragma once
/// \file Commands to a running simulation, as values that can be queued, recorded and replayed.
///
/// A command is a struct with its data, and says itself what it is (`kKind`, `describe`), whether
/// its data make sense (`validationError`), what it does (`apply`), whether that wakes a sleeping
/// cloth (`kWakes`), and how it is stored (`serialize`). A new one is a header in sim/commands/ and
/// an entry in `Command`, at its end: recordings store the position in this list.

#include <variant>

#include "cloth_sim/sim/commands/clamp_commands.h"
#include "cloth_sim/sim/commands/cut_along.h"
#include "cloth_sim/sim/commands/obstacle_commands.h"
#include "cloth_sim/sim/commands/pull_particle.h"
#include "cloth_sim/sim/commands/refine_mesh.h"
#include "cloth_sim/sim/commands/reset.h"
#include "cloth_sim/sim/commands/set_gravity.h"
#include "cloth_sim/sim/commands/set_phase.h"
#include "cloth_sim/sim/commands/set_quasi_static.h"
#include "cloth_sim/sim/commands/set_resolution.h"
#include "cloth_sim/sim/commands/set_stiffness.h"
#include "cloth_sim/sim/commands/set_tearing.h"
#include "cloth_sim/sim/commands/set_wind.h"

namespace cloth_sim {

/// Any command.
using Command = std::variant<SetClampTarget, GuideClamp, SetGripForce, SetGapWidth, CreateClamp,
                             DeleteClamp, SetGrasp, SetPhase, SetGravity, MoveObstacle,
                             GuideObstacle, SetTearing, SetWind, SetStiffness, SetQuasiStatic,
                             PullParticle, CutAlong, RefineMesh, Reset, Restore, SetResolution>;

/// Returns why a command cannot be carried out in any simulation; empty if it can in some.
inline std::string validationError(const Command& command) {
  return std::visit([](const auto& it) { return it.validationError(); }, command);
}

/// Tells whether a command replaces the cloth by another one, so that whatever was known of it is
/// void.
inline bool replacesCloth(const Command& command) {
  if (const auto* reset = std::get_if<Reset>(&command)) return reset->scope != ResetScope::kTime;
  return std::holds_alternative<Restore>(command) || std::holds_alternative<SetResolution>(command);
}

/// Tells whether a command makes the simulated time jump.
inline bool changesTime(const Command& command) {
  return std::holds_alternative<Reset>(command) || std::holds_alternative<Restore>(command) ||
         std::holds_alternative<SetResolution>(command);
}

}  // namespace cloth_sim
