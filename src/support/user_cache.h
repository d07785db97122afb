#pragma once
/// \file Files that programs keep for a user from run to run.

#include <string>

namespace cloth_sim {

/// Returns the path of a file in $CLOTH_SIM_CACHE, $XDG_CACHE_HOME/cloth_sim or
/// $HOME/.cache/cloth_sim, whichever is set first; "" if none is set.
std::string userCacheFile(const std::string& name);

}  // namespace cloth_sim
