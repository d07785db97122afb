#pragma once
/// \file The list of the built-in fabrics for programs to read.

#include <string>

namespace cloth_sim {

/// Returns the sheets of the built-in fabrics as JSON; docs/fabrics.md explains its keys.
std::string fabricListJson();

}  // namespace cloth_sim
