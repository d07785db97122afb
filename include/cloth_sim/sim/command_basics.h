#pragma once
/// \file ConnectedComponents that every command is made of.

#include <string>
#include <vector>

#include "cloth_sim/sim/simulation_parts.h"
#include "cloth_sim/validation.h"

namespace cloth_sim {

/// Tells whether a command was carried out, and if not, why, in one sentence.
struct CommandResult {
  bool success = false;
  std::string message;
  /// A doubt about a command that was carried out, as a sentence without numbers; "" if none.
  std::string warning = {};
};

inline CommandResult done(const std::string& message = "") { return {true, message}; }
inline CommandResult refuse(const std::string& message) { return {false, message}; }

/// Returns the refusal of a name that nothing has: "unknown clamp 'lef' (known: left, right)".
CommandResult refuseUnknown(const std::string& kind, const std::string& name,
                            const std::vector<std::string>& known);

/// When a command that was carried out wakes a sleeping cloth.
enum class Wakes {
  kAlways,
  kIfSomethingMoves,  ///< not if everything is told to be where it is
  kNever,
};

/// Returns a vector as text for people: "(0.1, 0, 0.5)".
std::string toText(const Vec3& v);

}  // namespace cloth_sim
