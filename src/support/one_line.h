#pragma once
/// \file Text on one line.

#include <string>

namespace cloth_sim {

/// Returns the text with spaces in place of line breaks and other control characters.
std::string oneLine(std::string text);

}  // namespace cloth_sim
