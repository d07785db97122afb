#include <algorithm>
#include <set>

#include "readers.h"
#include "section.h"

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

/// Reads the target of a clamp, which replaces the target that the action had.
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

/// Keys that are read by hand exclude each other, or replace each other.
const Section<ClampAction> kClampActionSection{"`phases.<name>.clamps.<name>`",
                                               {{"hold", &ClampAction::hold},
                                                {"attach", &ClampAction::attach},
                                                {"grasp", &ClampAction::grasp},
                                                {"move_by"},
                                                {"move_to"},
                                                {"rpy"},
                                                {"orientation"},
                                                {"speed", &ClampAction::speed, kPositive}}};

void readClampAction(const SceneNode& node, const ClampSpec& clamp, ClampAction& action) {
  kClampActionSection.read(node, action);
  if (action.hold && (node.has("attach") || node.has("move_by") || node.has("move_to"))) {
    node.refuse("expected either hold or a move (got both)");
  }
  if (action.attach) checkAttach(node, clamp);
  readMove(node, action);
  if (const auto orientation = readOrientation(node)) action.orientation = orientation;
}

/// Reads actions in the order of the scene's clamps. The action of one clamp replaces that of all.
void readClampActions(const SceneNode& node, const Scene& scene,
                      std::vector<ClampAction>& actions) {
  std::vector<std::string> names = clampNames(scene);
  names.push_back("all");
  for (const SceneNode& entry : node.entries()) checkKnown(entry, "clamp", names);
  const auto all = node.find("all");
  if (all) all->expectKeys(kClampActionSection.keys().names);
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

const Section<ObstacleAction> kObstacleActionSection{
    "`phases.<name>.obstacles.<name>`",
    {Key<ObstacleAction>::required("velocity", "[x, y, z]",
                                   [](const SceneNode& value, ObstacleAction& action) {
                                     action.velocity = value.vector<3>();
                                   }),
     {"angular_velocity", &ObstacleAction::angularVelocity}}};

void readObstacleActions(const SceneNode& node, const Scene& scene,
                         std::vector<ObstacleAction>& actions) {
  for (const SceneNode& entry : node.entries()) {
    checkKnown(entry, "obstacle", obstacleNames(scene));
    actions.push_back(kObstacleActionSection.read(entry));
    actions.back().obstacle = entry.key();
  }
}

const Section<PhaseSpec> kPhaseTearingSection{
    "`phases.<name>.tearing`",
    {{"enabled", &PhaseSpec::tearing},
     {"ratio", [](const SceneNode& value, PhaseSpec& phase) { phase.ratio = readRatios(value); }}}};

const KeyTable kNotchKeys{"`phases.<name>.notch`", {"cloth", "path"}};

/// Reads a path on the first cloth, or a map with a path and the name of its cloth.
MaterialPath readNotch(const SceneNode& node, const std::vector<ClothSpec>& cloths) {
  if (!node.isMap()) return readPath(node, cloths, 0);
  node.expectKeys(kNotchKeys.names);
  const std::size_t cloth = readClothName(node, cloths);
  return readPath(node.need("path", "a list of points [u, v]"), cloths, cloth);
}

/// Reads one notch or a list of notches. In a list of notches the first item is a map, or the first
/// item of the first item is a list.
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

const Section<PhaseConditions> kMeanSpeedSection{
    "`phases.<name>.until.mean_speed`",
    {Key<PhaseConditions>::required("below", kPositive.text(),
                                    [](const SceneNode& value, PhaseConditions& until) {
                                      until.meanSpeedBelow = value.number(kPositive);
                                    }),
     {"for", &PhaseConditions::meanSpeedFor, kNotNegative}}};

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

/// `clamps` is read by hand: it needs the clamps of the scene.
const Section<PhaseConditions> kUntilSection{
    "`phases.<name>.until`",
    {{"elapsed", &PhaseConditions::elapsed, kNotNegative},
     {"mean_speed",
      [](const SceneNode& value, PhaseConditions& until) { kMeanSpeedSection.read(value, until); }},
     {"contact", &PhaseConditions::contact},
     {"clamps"},
     {"pieces", &PhaseConditions::piecesAtLeast, 1, kMaxCount},
     {"broken", &PhaseConditions::brokenAtLeast, 1, kMaxCount}}};

void readConditions(const SceneNode& node, const Scene& scene, PhaseConditions& until) {
  kUntilSection.read(node, until);
  if (const auto clamps = node.find("clamps")) readClampCondition(*clamps, scene, until);
}

void readEnd(const SceneNode& node, const Scene& scene, PhaseSpec& phase) {
  if (const auto until = node.find("until")) readConditions(*until, scene, phase.until);
  const auto onTimeout = node.find("on_timeout");
  if (!onTimeout) return;
  if (!phase.timeout) onTimeout->refuse("expected a timeout beside it");
  phase.onTimeout = onTimeout->choice<OnTimeout>(
      {{"continue", OnTimeout::kContinue}, {"fail", OnTimeout::kFail}});
}

/// Keys that are read by hand need the rest of the scene, or each other.
const Section<PhaseSpec> kPhaseSection{
    "`phases.<name>`",
    {Key<PhaseSpec>::required(
         "name", "a name",
         [](const SceneNode& value, PhaseSpec& phase) { phase.name = value.word("a name"); }),
     {"clamps"},
     {"obstacles"},
     {"wind", [](const SceneNode& value, PhaseSpec& phase) { phase.wind = readWind(value); }},
     {"tearing",
      [](const SceneNode& value, PhaseSpec& phase) { kPhaseTearingSection.read(value, phase); }},
     {"quasi_static", &PhaseSpec::quasiStatic},
     {"notch"},
     {"cut", [](const SceneNode& value, PhaseSpec& phase) { readStrokes(value, phase.strokes); }},
     {"refine",
      [](const SceneNode& value, PhaseSpec& phase) { readRefinements(value, phase.refinements); }},
     {"until"},
     {"timeout", &PhaseSpec::timeout, kPositive},
     {"on_timeout"}}};

PhaseSpec readPhase(const SceneNode& node, const Scene& scene) {
  PhaseSpec phase = kPhaseSection.read(node);
  if (const auto clamps = node.find("clamps")) readClampActions(*clamps, scene, phase.clamps);
  if (const auto obstacles = node.find("obstacles")) {
    readObstacleActions(*obstacles, scene, phase.obstacles);
  }
  if (const auto notch = node.find("notch")) readNotches(*notch, scene.cloths, phase.notches);
  readEnd(node, scene, phase);
  return phase;
}

}  // namespace

void readPhases(const SceneNode& node, const Scene& scene, std::vector<PhaseSpec>& phases) {
  std::set<std::string> names;
  for (const SceneNode& item : node.list("a list of phases")) {
    PhaseSpec phase = readPhase(item, scene);
    if (!names.insert(phase.name).second) item.refuse("expected a name that no other phase has");
    phases.push_back(std::move(phase));
  }
}

void listPhaseKeys(std::vector<KeyTable>& tables) {
  for (const KeyTable& table : std::initializer_list<KeyTable>{
           kPhaseSection.keys(), kClampActionSection.keys(), kObstacleActionSection.keys(),
           kPhaseTearingSection.keys(), kNotchKeys, kUntilSection.keys(),
           kMeanSpeedSection.keys()}) {
    tables.push_back(table);
  }
}

}  // namespace cloth_sim
