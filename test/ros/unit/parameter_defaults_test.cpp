/// \file docs/ros_api.md gives the defaults of the node's parameters.

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <regex>
#include <string>

#include "ros/parameters.h"

namespace cloth_sim {
namespace {

/// The third column of the table of parameters, by name.
std::map<std::string, std::string> documentedDefaults() {
  std::ifstream page(CLOTH_SIM_SOURCE_DIR "/docs/ros_api.md");
  const std::regex row(R"(\| `~(\w+)` \|[^|]*\| `([^`]*)` \|.*)");
  std::map<std::string, std::string> defaults;
  for (std::string line; std::getline(page, line) && line != "## Dynamic parameters";) {
    std::smatch match;
    if (std::regex_match(line, match, row)) defaults[match[1]] = match[2];
  }
  return defaults;
}

std::string text(const std::string& value) { return value; }
std::string text(bool value) { return value ? "true" : "false"; }
std::string text(int value) { return std::to_string(value); }
/// One digit after the decimal point.
std::string text(double value) {
  const std::string digits = std::to_string(value);
  return digits.substr(0, digits.find('.') + 2);
}

TEST(ParameterDefaults, AreTheDocumentedOnes) {
  const NodeParameters defaults;
  const std::map<std::string, std::string> expected{
      {"scene", text(defaults.scene)},
      {"set", defaults.set.empty() ? "[]" : "not empty"},
      {"world_frame", text(defaults.worldFrame)},
      {"rate_markers", text(defaults.rateMarkers)},
      {"rate_frame", text(defaults.rateFrame)},
      {"rate_surface", text(defaults.rateSurface)},
      {"rate_state", text(defaults.rateState)},
      {"rate_wrench", text(defaults.rateWrench)},
      {"rate_follow", text(defaults.rateTracking)},
      {"wrench_cutoff", text(defaults.wrenchCutoff)},
      {"real_time_factor", text(defaults.realTimeFactor)},
      {"threads", text(defaults.threads)},
      {"paused", text(defaults.paused)},
      {"publish_clock", text(defaults.publishClock)},
      {"state_directory", text(defaults.stateDirectory)},
      {"strain_range", text(defaults.strainRange)},
      {"handles", text(defaults.handles)},
      {"two_sided", text(defaults.twoSided)},
      {"follow", defaults.clampSources.empty() ? "{}" : "not empty"},
      {"follow_obstacle", defaults.obstacleSources.empty() ? "{}" : "not empty"},
      {"robot", defaults.robot ? "not empty" : "{}"},
      {"camera", defaults.camera ? "not empty" : "{}"},
      {"diagnostic_period", "1.0"},  // of diagnostic_updater
  };
  EXPECT_EQ(documentedDefaults(), expected);
}

}  // namespace
}  // namespace cloth_sim
