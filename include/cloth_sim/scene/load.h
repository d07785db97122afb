#pragma once
/// \file Reads scene files.

#include <stdexcept>
#include <string>
#include <vector>

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// The error of a scene: one line that names the file, the line, the key and what was expected,
/// such as "tear.yaml:12: cloth.fabric.areal_density: expected a number > 0 (got -1)".
class SceneError : public std::runtime_error {
 public:
  /// \param text  control characters in it, as of names of files, become spaces.
  explicit SceneError(const std::string& text);
};

/// Reads and validates a YAML scene. An unknown key is an error that suggests the nearest known
/// key. \param overrides  "dotted.key=value" each, applied before validation; list items go by
///                   number or, where they have one, by name ("clamps.left.gap_open=0.1").
/// \throws SceneError
Scene loadScene(const std::string& path, const std::vector<std::string>& overrides = {});

/// Reads a scene from text. \param name  stands for the file in messages.
Scene parseScene(const std::string& yaml, const std::string& name,
                 const std::vector<std::string>& overrides = {});

}  // namespace cloth_sim
