#pragma once
/// \file Scenes of tests: shipped ones, and texts that are scenes or are refused.

#include <string>
#include <vector>

#include "cloth_sim/scene/load.h"

#ifndef CLOTH_SIM_SOURCE_DIR
#define CLOTH_SIM_SOURCE_DIR "."
#endif

namespace cloth_sim::testing_support {

/// The file of a shipped scene.
inline std::string shipped(const std::string& name) {
  return std::string(CLOTH_SIM_SOURCE_DIR) + "/config/scenes/" + name + ".yaml";
}

/// Returns the error message of a scene; "" if it is valid.
inline std::string complaint(const std::string& yaml,
                             const std::vector<std::string>& overrides = {}) {
  try {
    parseScene(yaml, "s.yaml", overrides);
    return "";
  } catch (const SceneError& error) {
    return error.what();
  }
}

inline Scene parse(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
  return parseScene(yaml, "s.yaml", overrides);
}

}  // namespace cloth_sim::testing_support
