#pragma once
/// \file Numbers in messages.

#include <string>

namespace cloth_sim {

/// Formats a number for messages, such as "0.12".
/// \param digits  significant ones, at most.
std::string shortNumber(double value, int digits = 6);

}  // namespace cloth_sim
