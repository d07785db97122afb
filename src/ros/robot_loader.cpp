#include "robot_loader.h"

#include <ros/package.h>

#include <algorithm>

#include "scene/names.h"

namespace cloth_sim {
namespace {

/// Returns the folder of a package. Looks through the list of packages, because a search for one
/// that is not there prints an error of its own.
std::string packageFolder(const std::string& package) {
  std::vector<std::string> known;
  ros::package::getAll(known);
  if (std::find(known.begin(), known.end(), package) == known.end()) {
    throw RobotError("there is no package '" + shownText(package) + "'");
  }
  return ros::package::getPath(package);
}

/// Returns the path of the file that a URDF names.
std::string findMesh(const std::string& url) {
  const std::string package = "package://";
  const std::string file = "file://";
  if (url.compare(0, file.size(), file) == 0) return url.substr(file.size());
  if (url.compare(0, package.size(), package) != 0) return url;
  const std::size_t slash = std::min(url.find('/', package.size()), url.size());
  return packageFolder(url.substr(package.size(), slash - package.size())) + url.substr(slash);
}

}  // namespace

Robot loadRobot(const ros::NodeHandle& node, const NodeParameters& parameters) {
  if (!parameters.robot) return {};
  const RobotSettings& settings = *parameters.robot;
  try {
    std::string urdf;
    if (!node.getParam(settings.description, urdf)) {
      throw RobotError("there is no parameter " + node.resolveName(settings.description) +
                       " with a URDF");
    }
    const Robot robot = chooseLinks(RobotDescription(urdf), settings, findMesh);
    for (const RobotGripper& gripper : robot.grippers) {
      if (parameters.clampSources.count(gripper.clamp) == 0) continue;
      throw RobotError("clamp '" + gripper.clamp + "' is in ~follow, too");
    }
    return robot;
  } catch (const std::runtime_error& error) {
    throw ParameterError("~robot: " + std::string(error.what()));
  }
}

void checkRobot(const Robot& robot, const Scene& withoutIt, const Scene& scene) {
  std::vector<std::string> obstacles;
  std::vector<std::string> clamps;
  for (const Obstacle& obstacle : withoutIt.obstacles) obstacles.push_back(obstacle.name);
  for (const ClampSpec& clamp : scene.clamps) clamps.push_back(clamp.name);
  try {
    checkNames(robot, obstacles, clamps);
  } catch (const RobotError& error) {
    throw ParameterError("~robot: " + std::string(error.what()));
  }
}

}  // namespace cloth_sim
