#pragma once
/// \file The folder with saved states. No ROS in here.

#include <string>
#include <vector>

namespace cloth_sim {

/// Files "<name>.state" in one folder. Names are checked by stateNameError; links in the
/// folder are not followed.
class StateDirectory {
 public:
  /// \param folder  made when something is saved; "~/" at its beginning is the user's home.
  explicit StateDirectory(const std::string& folder);

  /// \return the file.
  /// \throws StateError in one line.
  std::string write(const std::string& name, const std::string& bytes) const;
  std::string read(const std::string& name) const;
  /// Names of what is there, sorted.
  std::vector<std::string> names() const;

 private:
  std::string path(const std::string& name) const;

  std::string folder_;
};

}  // namespace cloth_sim
