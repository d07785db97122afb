#pragma once
/// \file The folder of saved states. No ROS in here.

#include <string>
#include <vector>

namespace cloth_sim {

/// Files "<name>.state" in one folder. Names are checked by stateNameError; links in the
/// folder are not followed.
class StateDirectory {
 public:
  /// \param folder  created by the first `write`; a leading "~" is the user's home, and "~/.ros"
  /// the
  ///                folder in the environment variable ROS_HOME, if it is set.
  explicit StateDirectory(const std::string& folder);

  /// Writes a state. \return the file. \throws StateError or FileError in one line.
  std::string write(const std::string& name, const std::string& bytes) const;
  /// Reads a state. \throws StateError or FileError in one line.
  std::string read(const std::string& name) const;
  /// Names the saved states, sorted.
  std::vector<std::string> names() const;

 private:
  std::string path(const std::string& name) const;

  std::string folder_;
};

}  // namespace cloth_sim
