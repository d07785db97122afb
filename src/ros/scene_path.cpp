#include "scene_path.h"

#include <ros/package.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "cloth_sim/scene/load.h"
#include "scene/names.h"

namespace cloth_sim {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> sceneNames(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

std::string resolveScene(const std::string& scene) {
  if (scene.empty())
    throw SceneError("scene: expected a file or the name of a scene (got nothing)");
  std::error_code ignored;
  if (fs::is_regular_file(scene, ignored)) return scene;
  const bool exists = fs::exists(scene, ignored);  // as a directory or the like: the reader says it
  if (scene.find('/') != std::string::npos) {
    if (exists) return scene;
    throw SceneError(scene + ": no such scene file");
  }

  const std::string package = ros::package::getPath("cloth_sim");
  if (package.empty()) {
    throw SceneError(scene + ": no such scene file (and the package cloth_sim is not on " +
                     "ROS_PACKAGE_PATH, so its scenes were not searched)");
  }
  const fs::path folder = fs::path(package) / "config" / "scenes";
  for (const fs::path& candidate : {folder / scene, folder / (scene + ".yaml")}) {
    if (fs::is_regular_file(candidate, ignored)) return candidate.string();
  }
  if (exists) return scene;
  throw SceneError(scene + ": no such scene file, nor a scene of the package (known: " +
                   joinNames(sceneNames(folder), kAllNames) + ")");
}

}  // namespace cloth_sim
