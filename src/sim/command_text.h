#pragma once
/// \file Commands as bytes, to be kept and carried out again, and as words.

#include <string>

#include "cloth_sim/sim/command.h"

namespace cloth_sim {

std::string packCommand(const Command& command);
/// \throws StateError if `bytes` are of another version, or none of `packCommand`.
Command unpackCommand(const std::string& bytes);

/// What it is in one word, such as "set_clamp_target".
const char* commandKind(const Command& command);
/// What it says, for people: "left to (0.1, 0, 0.5)".
std::string describeCommand(const Command& command);

}  // namespace cloth_sim
