#pragma once
/// \file Where scenes are.

#include <string>

namespace cloth_sim {

/// The file that a user means by `scene`: a path, or a bare name ("tear_seam", with or without
/// ".yaml") of one of the package's config/scenes. A path that exists wins.
/// \throws SceneError if there is no such file, naming the scenes there are.
std::string resolveScene(const std::string& scene);

}  // namespace cloth_sim
