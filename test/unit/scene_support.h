#pragma once
/// \file Scenes of tests: shipped ones, texts that are scenes, and the errors of others.

#include <string>
#include <vector>

#include "cloth_sim/scene/load.h"

#ifndef CLOTH_SIM_SOURCE_DIR
#define CLOTH_SIM_SOURCE_DIR "."
#endif

namespace cloth_sim::testing_support {

/// The folder of the shipped scenes.
inline std::string sceneFolder() { return std::string(CLOTH_SIM_SOURCE_DIR) + "/config/scenes"; }

/// The file of a shipped scene.
inline std::string shipped(const std::string& name) { return sceneFolder() + "/" + name + ".yaml"; }

/// Returns the message of the error of a scene that `action` throws; "" if it throws none.
template <typename Action>
std::string sceneErrorOf(const Action& action) {
  try {
    action();
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

inline Scene parse(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
  return parseScene(yaml, "s.yaml", overrides);
}

/// Returns the error message of a scene; "" if it is valid.
inline std::string complaint(const std::string& yaml,
                             const std::vector<std::string>& overrides = {}) {
  return sceneErrorOf([&] { parse(yaml, overrides); });
}

}  // namespace cloth_sim::testing_support
