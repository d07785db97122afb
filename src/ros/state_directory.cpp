#include "state_directory.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "cloth_sim/sim/saved_state.h"
#include "scene/names.h"
#include "support/input_file.h"
#include "support/output_file.h"

namespace cloth_sim {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEnding = ".state";

/// Returns the path with `to` in place of the leading folders `from`, if it has them.
std::optional<std::string> replaced(const std::string& path, const std::string& from,
                                    const char* to) {
  if (to == nullptr || *to == '\0') return std::nullopt;
  if (path != from && path.compare(0, from.size() + 1, from + '/') != 0) return std::nullopt;
  return to + path.substr(from.size());
}

/// Returns the folder with ROS's folder in place of "~/.ros", or the user's home in place of "~".
std::string withHome(const std::string& folder) {
  if (const auto path = replaced(folder, "~/.ros", std::getenv("ROS_HOME"))) return *path;
  return replaced(folder, "~", std::getenv("HOME")).value_or(folder);
}

}  // namespace

StateDirectory::StateDirectory(const std::string& folder)
    : folder_(fs::absolute(withHome(folder)).lexically_normal().string()) {}

std::string StateDirectory::path(const std::string& name) const {
  return (fs::path(folder_) / (name + kEnding)).string();
}

std::string StateDirectory::write(const std::string& name, const std::string& bytes) const {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw StateError(folder_ + ": cannot be made (" + error.message() + ")");
  OutputFile(path(name), {Links::kRefused, true}).write(bytes);
  return path(name);
}

std::string StateDirectory::read(const std::string& name) const {
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(path(name), ignored))) {
    throw StateError(unknownName("saved state", name, names()));
  }
  return readInputFile(path(name), {kMaxStateSize, Links::kRefused});
}

std::vector<std::string> StateDirectory::names() const {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, ignored)) {
    if (entry.path().extension() == kEnding) names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace cloth_sim
