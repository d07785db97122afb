#include "user_cache.h"

#include <cstdlib>
#include <utility>

namespace cloth_sim {

std::string userCacheFile(const std::string& name) {
  for (const auto& [variable, below] :
       {std::pair{"CLOTH_SIM_CACHE", "/"}, std::pair{"XDG_CACHE_HOME", "/cloth_sim/"},
        std::pair{"HOME", "/.cache/cloth_sim/"}}) {
    const char* folder = std::getenv(variable);
    if (folder != nullptr && *folder != '\0') return folder + std::string(below) + name;
  }
  return "";
}

}  // namespace cloth_sim
