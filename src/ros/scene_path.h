#pragma once
/// \file Finds scene files.

#include <string>

namespace cloth_sim {

/// Returns the file that a user means by `scene`: a path, or a bare name ("tear_seam", with or
/// without
/// ".yaml") of one of the package's config/scenes. A path that exists wins.
/// \throws SceneError naming the known scenes if there is no such file.
std::string resolveScene(const std::string& scene);

}  // namespace cloth_sim
