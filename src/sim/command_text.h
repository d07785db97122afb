#pragma once
/// \file Commands as bytes, for recordings, and as text, for people.

#include <string>

#include "cloth_sim/sim/command.h"

namespace cloth_sim {

/// Returns a command as bytes, from which `unpackCommand` makes it again to the bit.
std::string packCommand(const Command& command);
/// \throws StateError if `bytes` are of another version, or not from `packCommand`.
Command unpackCommand(const std::string& bytes);

/// Returns the kind of a command: "set_clamp_target".
const char* commandKind(const Command& command);
/// Returns the contents of a command in a few words: "left to (0.1, 0, 0.5)".
std::string describeCommand(const Command& command);

}  // namespace cloth_sim
