#include "robot.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <set>

#include "scene/names.h"

namespace cloth_sim {
namespace {

/// Where the obstacles of a robot wait until tf knows their links [m].
constexpr const char* kAway = "[0, 0, -1000]";

bool isIn(const std::string& name, const std::vector<std::string>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// ---- choice of links --------------------------------------------------------------------------

std::vector<std::string> plateLinks(const RobotSettings& settings) {
  std::vector<std::string> links;
  for (const auto& [clamp, gripper] : settings.clamps) {
    links.insert(links.end(), gripper.plates.begin(), gripper.plates.end());
  }
  return links;
}

/// All links with collision geometry but the plates of clamps.
std::vector<std::string> solidLinks(const RobotDescription& description,
                                    const RobotSettings& settings) {
  const std::vector<std::string> plates = plateLinks(settings);
  std::vector<std::string> links;
  bool anySolid = false;
  for (const std::string& link : description.links()) {
    if (!description.isSolid(link)) continue;
    anySolid = true;
    if (!isIn(link, plates)) links.push_back(link);
  }
  if (!anySolid) throw RobotError("the URDF has no collision geometry");
  return links;
}

void requireSolid(const RobotDescription& description, const std::string& link) {
  if (!description.isSolid(link)) {
    throw RobotError("link '" + shownText(link) + "' has no collision geometry");
  }
}

/// The links that are obstacles.
std::vector<std::string> obstacleLinks(const RobotDescription& description,
                                       const RobotSettings& settings) {
  for (const std::string& link : settings.selfFilter) description.isSolid(link);
  for (const std::string& link : settings.links) requireSolid(description, link);
  std::vector<std::string> links;
  for (const std::string& link :
       settings.links.empty() ? solidLinks(description, settings) : settings.links) {
    if (!isIn(link, settings.selfFilter) && !isIn(link, links)) links.push_back(link);
  }
  return links;
}

/// Returns a name of letters, digits and _ that no other part of the robot has.
std::string nameFor(const std::string& link, std::set<std::string>& taken) {
  std::string base = link;
  std::replace_if(
      base.begin(), base.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  std::string name = base;
  for (int number = 2; !taken.insert(name).second; ++number) {
    name = base + "_" + std::to_string(number);
  }
  return name;
}

/// The motor of a gripper; nothing if it has none.
std::optional<GripMotor> motorOf(const RobotDescription& description,
                                 const GripperSettings& settings) {
  if (settings.motor.empty()) return std::nullopt;
  const RobotJoint joint = description.joint(settings.motor);
  const bool movesFirst = description.hangsOn(settings.plates[0], joint.link);
  if (movesFirst == description.hangsOn(settings.plates[1], joint.link)) {
    throw RobotError("joint '" + settings.motor + "' does not move one plate against the other");
  }
  return GripMotor{settings.motor, joint, movesFirst ? 0U : 1U, settings.friction};
}

RobotGripper gripperOf(const RobotDescription& description, const std::string& clamp,
                       const GripperSettings& settings, const MeshFinder& find) {
  const std::array<std::string, 2>& links = settings.plates;
  RobotGripper gripper{clamp, "", {}, {}};
  if (links[0] == links[1]) throw RobotError("clamp '" + clamp + "': expected two links as plates");
  for (std::size_t k = 0; k < links.size(); ++k) {
    requireSolid(description, links[k]);
    gripper.plates[k] = {links[k], boxAround(description.collision(links[k], find))};
  }
  gripper.base = description.commonParent(links[0], links[1]);
  gripper.motor = motorOf(description, settings);
  return gripper;
}

// ---- overrides --------------------------------------------------------------------------------

std::string yamlOf(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}
std::string yamlOf(bool isOn) { return isOn ? "true" : "false"; }
std::string yamlOf(const Vec3& value) {
  return "[" + yamlOf(value.x()) + ", " + yamlOf(value.y()) + ", " + yamlOf(value.z()) + "]";
}
/// The name in single quotes, in which only these need doubling.
std::string yamlOf(const SurfaceFile& file) {
  std::string text = "'";
  for (const char c : file.name) text += c == '\'' ? "''" : std::string(1, c);
  return text + "'";
}

std::string yamlOf(const Shape& shape) {
  std::string text = "{type: " + typeNames(shape).front();
  const auto add = [&text](const char* key, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, std::optional<Vec3>>) {
      if (value) text += std::string(", ") + key + ": " + yamlOf(*value);
    } else {
      text += std::string(", ") + key + ": " + yamlOf(value);
    }
  };
  std::visit([&add](const auto& known) { forEachKey(known, add); }, shape);
  return text + ", position: " + kAway + "}";
}

}  // namespace

Robot chooseLinks(const RobotDescription& description, const RobotSettings& settings,
                  const MeshFinder& find) {
  Robot robot;
  std::set<std::string> taken;
  for (const std::string& link : obstacleLinks(description, settings)) {
    for (const CollisionPart& part : description.collision(link, find)) {
      robot.obstacles.push_back({nameFor(link, taken), link, part});
    }
  }
  for (const auto& [clamp, gripper] : settings.clamps) {
    robot.grippers.push_back(gripperOf(description, clamp, gripper, find));
  }
  return robot;
}

std::vector<std::string> overridesOf(const std::vector<RobotObstacle>& obstacles) {
  std::vector<std::string> overrides;
  overrides.reserve(obstacles.size());
  for (const RobotObstacle& it : obstacles) {
    overrides.push_back("obstacles." + it.name + "=" + yamlOf(it.part.shape));
  }
  return overrides;
}

void checkNames(const Robot& robot, const std::vector<std::string>& obstacles,
                const std::vector<std::string>& clamps) {
  for (const RobotObstacle& it : robot.obstacles) {
    if (!isIn(it.name, obstacles)) continue;
    throw RobotError("the scene has an obstacle '" + it.name +
                     "' already: leave one of them out (self_filter: [" + it.link + "])");
  }
  for (const RobotGripper& it : robot.grippers) {
    if (!isIn(it.clamp, clamps)) throw RobotError(unknownName("clamp", it.clamp, clamps));
  }
}

}  // namespace cloth_sim
