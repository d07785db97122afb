#include <algorithm>

#include "keys.h"
#include "readers.h"

namespace cloth_sim {

namespace {

constexpr int kMaxCount = 1000000000;

std::vector<std::string> clampNames(const Scene& scene) {
  std::vector<std::string> names;
  for (const ClampSpec& clamp : scene.clamps) names.push_back(clamp.name);
  return names;
}

std::vector<std::string> obstacleNames(const Scene& scene) {
  std::vector<std::string> names;
  for (const Obstacle& obstacle : scene.obstacles) names.push_back(obstacle.name);
  return names;
}

void checkKnown(const SceneNode& node, const char* noun, const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), node.key()) != names.end()) return;
  const std::string near = nearestName(node.key(), names);
  node.refuse(std::string("there is no ") + noun + " of this name" +
              (near.empty() ? "" : ", did you mean '" + near + "'?") + " (the scene has " +
              joinNames(names) + ")");
}

void checkAttach(const SceneNode& node, const ClampSpec& clamp) {
  if (!node.has("attach") || clamp.patch) return;
  node.refuse("expected no attach, as clamp '" + clamp.name + "' has no patch");
}

/// Where the clamp is told to go; replaces what `action` said about it.
void readMove(const SceneNode& node, ClampAction& action) {
  const bool by = node.has("move_by");
  const bool to = node.has("move_to");
  if (by && to) node.refuse("expected either move_by or move_to (got both)");
  if (by || to) {
    action.moveBy.reset();
    action.moveTo.reset();
  }
  node.read("move_by", action.moveBy);
  node.read("move_to", action.moveTo);
  if (action.attach && action.moveTo) node.refuse("expected either attach or move_to (got both)");
}

void readClampAction(const SceneNode& node, const ClampSpec& clamp, ClampAction& action) {
  node.expectKeys(keys::kClampAction);
  node.read("hold", action.hold);
  if (action.hold && (node.has("attach") || node.has("move_by") || node.has("move_to"))) {
    node.refuse("expected either hold or a move (got both)");
  }
  node.read("attach", action.attach);
  if (action.attach) checkAttach(node, clamp);
  node.read("grasp", action.grasp);
  readMove(node, action);
  if (const auto orientation = readOrientation(node)) action.orientation = orientation;
  node.read("speed", action.speed, kPositive);
}

/// In the order of the scene's clamps; what is said of one replaces what is said of all.
void readClampActions(const SceneNode& node, const Scene& scene,
                      std::vector<ClampAction>& actions) {
  std::vector<std::string> names = clampNames(scene);
  names.push_back("all");
  for (const SceneNode& entry : node.entries()) checkKnown(entry, "clamp", names);
  const auto all = node.find("all");
  if (all) all->expectKeys(keys::kClampAction);
  for (const ClampSpec& clamp : scene.clamps) {
    const auto own = node.find(clamp.name);
    if (!all && !own) continue;
    ClampAction action;
    action.clamp = clamp.name;
    if (all) readClampAction(*all, clamp, action);
    if (own) readClampAction(*own, clamp, action);
    actions.push_back(action);
  }
}

void readObstacleActions(const SceneNode& node, const Scene& scene,
                         std::vector<ObstacleAction>& actions) {
  for (const SceneNode& entry : node.entries()) {
    checkKnown(entry, "obstacle", obstacleNames(scene));
    entry.expectKeys(keys::kObstacleAction);
    actions.push_back({entry.key(), entry.need("velocity", "[x, y, z]").vector<3>()});
  }
}

void readPhaseTearing(const SceneNode& node, PhaseSpec& phase) {
  node.expectKeys(keys::kPhaseTearing);
  node.read("enabled", phase.tearing);
  if (const auto ratio = node.find("ratio")) phase.ratio = readRatios(*ratio);
}

/// Points of the first cloth, or a map that names another.
MaterialPath readNotch(const SceneNode& node, const std::vector<ClothSpec>& cloths) {
  if (!node.isMap()) return readPath(node, cloths, 0);
  node.expectKeys(keys::kNotch);
  const std::size_t cloth = readClothName(node, cloths);
  return readPath(node.need("path", "a list of points [u, v]"), cloths, cloth);
}

/// One notch, or a list of them: there, the first item is a map, or its first point is a list too.
void readNotches(const SceneNode& node, const std::vector<ClothSpec>& cloths,
                 std::vector<MaterialPath>& notches) {
  if (node.isMap()) return notches.push_back(readNotch(node, cloths));
  const std::string what = "a list of points [u, v], or a list of such lists";
  const std::vector<SceneNode> items = node.list(what);
  if (items.empty()) node.expected(what);
  if (!items.front().isMap()) {
    const std::vector<SceneNode> first = items.front().list(what);
    if (first.empty() || !first.front().isList()) {
      return notches.push_back(readNotch(node, cloths));
    }
  }
  for (const SceneNode& item : items) notches.push_back(readNotch(item, cloths));
}

void readMeanSpeed(const SceneNode& node, PhaseConditions& until) {
  node.expectKeys(keys::kMeanSpeed);
  until.meanSpeedBelow = node.need("below", kPositive.text()).number(kPositive);
  node.read("for", until.meanSpeedFor, kNotNegative);
}

void readClampCondition(const SceneNode& node, const Scene& scene, PhaseConditions& until) {
  if (scene.clamps.empty()) node.refuse("there are no clamps in the scene to wait for");
  const auto add = [&until](const SceneNode& item) {
    bool* const condition =
        item.choice<bool*>({{"at_target", &until.clampsAtTarget}, {"closed", &until.clampsClosed}});
    *condition = true;
  };
  if (!node.isList()) return add(node);
  for (const SceneNode& item : node.list("a list of words")) add(item);
}

void readConditions(const SceneNode& node, const Scene& scene, PhaseConditions& until) {
  node.expectKeys(keys::kUntil);
  node.read("elapsed", until.elapsed, kNotNegative);
  if (const auto meanSpeed = node.find("mean_speed")) readMeanSpeed(*meanSpeed, until);
  node.read("contact", until.contact);
  if (const auto clamps = node.find("clamps")) readClampCondition(*clamps, scene, until);
  node.read("pieces", until.piecesAtLeast, 1, kMaxCount);
  node.read("broken", until.brokenAtLeast, 1, kMaxCount);
}

void readEnd(const SceneNode& node, const Scene& scene, PhaseSpec& phase) {
  if (const auto until = node.find("until")) readConditions(*until, scene, phase.until);
  node.read("timeout", phase.timeout, kPositive);
  const auto onTimeout = node.find("on_timeout");
  if (!onTimeout) return;
  if (!phase.timeout) onTimeout->refuse("expected a timeout beside it");
  phase.onTimeout = onTimeout->choice<OnTimeout>(
      {{"continue", OnTimeout::kContinue}, {"fail", OnTimeout::kFail}});
}

PhaseSpec readPhase(const SceneNode& node, const Scene& scene) {
  node.expectKeys(keys::kPhase);
  PhaseSpec phase;
  phase.name = node.need("name", "a name").word("a name");
  if (const auto clamps = node.find("clamps")) readClampActions(*clamps, scene, phase.clamps);
  if (const auto obstacles = node.find("obstacles")) {
    readObstacleActions(*obstacles, scene, phase.obstacles);
  }
  if (const auto wind = node.find("wind")) phase.wind = readWind(*wind);
  if (const auto tearing = node.find("tearing")) readPhaseTearing(*tearing, phase);
  if (const auto notch = node.find("notch")) readNotches(*notch, scene.cloths, phase.notches);
  if (const auto cut = node.find("cut")) readStrokes(*cut, phase.strokes);
  if (const auto refine = node.find("refine")) readRefinements(*refine, phase.refinements);
  readEnd(node, scene, phase);
  return phase;
}

}  // namespace

void readPhases(const SceneNode& node, const Scene& scene, std::vector<PhaseSpec>& phases) {
  for (const SceneNode& item : node.list("a list of phases")) {
    PhaseSpec phase = readPhase(item, scene);
    const bool twice = std::any_of(phases.begin(), phases.end(), [&](const PhaseSpec& other) {
      return other.name == phase.name;
    });
    if (twice) item.refuse("expected a name that no other phase has");
    phases.push_back(std::move(phase));
  }
}

}  // namespace cloth_sim
