#include "ros/state_directory.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace cloth_sim {
namespace {

namespace fs = std::filesystem;

/// A folder that is home or ROS's home while a test runs.
class StateDirectoryOfROS : public testing::Test {
 protected:
  StateDirectoryOfROS() {
    std::string name = (fs::temp_directory_path() / "state_directory_XXXXXX").string();
    folder_ = mkdtemp(name.data());
    set("HOME", (folder_ / "home").string());
    set("ROS_HOME", "");
  }
  void TearDown() override {
    for (const auto& [name, value] : before_) {
      if (value) {
        setenv(name.c_str(), value->c_str(), 1);
      } else {
        unsetenv(name.c_str());
      }
    }
    fs::remove_all(folder_);
  }

  void set(const std::string& name, const std::string& value) {
    const char* old = std::getenv(name.c_str());
    before_.emplace(name, old ? std::optional<std::string>(old) : std::nullopt);
    setenv(name.c_str(), value.c_str(), 1);
  }

  /// Returns where a state goes, from the temporary folder on.
  std::string placeOf(const std::string& directory) const {
    return fs::relative(StateDirectory(directory).write("a", "bytes"), folder_).string();
  }

  fs::path folder_;

 private:
  std::map<std::string, std::optional<std::string>> before_;
};

TEST_F(StateDirectoryOfROS, IsInTheHomeOfTheUser) {
  EXPECT_EQ(placeOf("~/.ros/cloth_sim"), "home/.ros/cloth_sim/a.state");
  EXPECT_EQ(placeOf("~"), "home/a.state");
}

TEST_F(StateDirectoryOfROS, FollowsROSHome) {
  set("ROS_HOME", (folder_ / "ros").string());
  EXPECT_EQ(placeOf("~/.ros/cloth_sim"), "ros/cloth_sim/a.state");
  EXPECT_EQ(placeOf("~/.ros"), "ros/a.state");
  EXPECT_EQ(placeOf("~/.rosette"), "home/.rosette/a.state");
  EXPECT_EQ(placeOf("~/states"), "home/states/a.state");
  EXPECT_EQ(placeOf((folder_ / "other").string()), "other/a.state");
}

}  // namespace
}  // namespace cloth_sim
