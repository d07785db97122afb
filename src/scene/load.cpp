#include "cloth_sim/scene/load.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "auto_method.h"
#include "names.h"
#include "readers.h"
#include "section.h"
#include "support/hash.h"
#include "support/input_file.h"
#include "support/one_line.h"

namespace cloth_sim {

namespace {

constexpr std::uint64_t kMaxFileSize = 16 << 20;  // [bytes]

/// Returns the name of a scene, such as "hang" for "config/scenes/hang.yaml".
std::string sceneName(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  const std::string file = slash == std::string::npos ? path : path.substr(slash + 1);
  return file.substr(0, file.find_last_of('.'));
}

std::string readFile(const std::string& path) {
  try {
    return readInputFile(path, {kMaxFileSize, Links::kFollowed});
  } catch (const FileError& error) {
    throw SceneError(error.what());
  }
}

const Section<Scene> kContactSection{
    "`contact`", {{"start", [](const SceneNode& value, Scene& scene) {
                     scene.startContact =
                         value.choice<StartContact>({{"refuse", StartContact::kRefuse},
                                                     {"untangle", StartContact::kUntangle}});
                   }}}};

/// Keys of the top level, in the order of reading: clamps refer to cloths, and phases to all keys
/// before them.
const Section<Scene> kSceneSection{
    kTopLevel,
    {Key<Scene>::required("cloth", "a map", readCloths),
     {"solver", [](const SceneNode& value, Scene& scene) { readSolver(value, scene.solver); }},
     {"gravity", &Scene::gravity},
     {"wind", [](const SceneNode& value, Scene& scene) { scene.wind = readWind(value); }},
     {"drag", &Scene::drag, kNotNegative},
     {"quasi_static", &Scene::quasiStatic},
     {"self_contact", &Scene::selfContact},
     {"contact", [](const SceneNode& value, Scene& scene) { kContactSection.read(value, scene); }},
     {"layer_friction", &Scene::layerFriction, kNotNegative},
     {"obstacles",
      [](const SceneNode& value, Scene& scene) { readObstacles(value, scene.obstacles); }},
     {"clamps",
      [](const SceneNode& value, Scene& scene) { readClamps(value, scene.cloths, scene.clamps); }},
     {"tearing", [](const SceneNode& value,
                    Scene& scene) { readTearing(value, scene.cloths, scene.tearing); }},
     {"phases",
      [](const SceneNode& value, Scene& scene) { readPhases(value, scene, scene.phases); }},
     {"seed", [](const SceneNode& value, Scene& scene) { scene.seed = value.seed(); }}}};

Scene readScene(const SceneNode& root) {
  Scene scene = kSceneSection.read(root);
  if (!root.has("solver")) scene.solver = defaultSolver();
  return scene;
}

void addText(const std::string& text, Hash& hash) {
  hash.add(text.data(), text.size());
  const std::uint64_t length = text.size();  // makes "ab", "c" differ from "a", "bc"
  hash.add(&length, sizeof length);
}

void addValue(const YamlValue& value, Hash& hash) {
  const std::array<std::uint64_t, 3> shape{static_cast<std::uint64_t>(value.kind),
                                           value.quoted ? 1U : 0U, value.items.size()};
  hash.add(shape.data(), sizeof shape);
  addText(value.key, hash);
  addText(value.text, hash);
  for (const YamlValue& item : value.items) addValue(item, hash);
}

std::string contentKey(const YamlValue& tree, double dt) {
  Hash hash;
  for (const YamlValue& item : tree.items) {
    if (item.key != "solver") addValue(item, hash);
  }
  char step[32];
  std::snprintf(step, sizeof step, "%.9g", dt);
  addText(step, hash);
  return hashText(hash.value());
}

void resolve(const SceneNode& root, Scene& scene) {
  if (!scene.solver.choice) return;
  try {
    resolveAutoMethod(scene);
  } catch (const std::exception& error) {
    root.need("solver", "a map").refuse(error.what());
  }
}

bool haveOneDamping(const std::vector<ClothSpec>& cloths) {
  return std::all_of(cloths.begin(), cloths.end(), [&](const ClothSpec& cloth) {
    return cloth.fabric.bendRetardation() == cloths.front().fabric.bendRetardation();
  });
}

/// Gives the bending energy of a plate to the cloths that name a fabric and leave their bending
/// open. They keep their bend springs where such an energy would be refused.
void chooseBending(const SceneNode& root, Scene& scene) {
  if (!findSolver(scene.solver.method).followsFabric || !haveOneDamping(scene.cloths)) return;
  const std::vector<SceneNode> nodes = clothNodes(root.need("cloth", "a map"));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    ClothSpec& cloth = scene.cloths[k];
    const bool isOpen = nodes[k].has("fabric") && !nodes[k].has("bending");
    if (!isOpen || cloth.raw || cloth.fabric.bending == 0.0) continue;
    cloth.springs.bend = false;
    cloth.plate = true;
  }
}

/// Refuses a bending energy that the method cannot follow, at the key that asks for it.
void checkFeatures(const SceneNode& root, const Scene& scene) {
  const std::vector<SceneNode> cloths = clothNodes(root.need("cloth", "a map"));
  for (std::size_t k = 0; k < scene.cloths.size(); ++k) {
    try {
      checkFeatures(findSolver(scene.solver.method), scene.cloths[k].plate);
    } catch (const std::invalid_argument& error) {
      cloths[k].need("bending", "a word").refuse(error.what());
    }
  }
}

/// Refuses friction in bending without a bending energy that it belongs to, or with a method that
/// has none.
void checkBendFriction(const SceneNode& root, const Scene& scene) {
  const std::vector<SceneNode> cloths = clothNodes(root.need("cloth", "a map"));
  for (std::size_t k = 0; k < scene.cloths.size(); ++k) {
    const ClothSpec& cloth = scene.cloths[k];
    if (cloth.fabric.bendingHysteresis == 0.0) continue;
    const SceneNode asked =
        cloths[k].need("fabric", "a map").need("bending_hysteresis", "a number");
    if (!cloth.plate) asked.refuse("expected only where the cloth bends by the energy of a plate");
    try {
      checkBendFriction(findSolver(scene.solver.method));
    } catch (const std::invalid_argument& error) {
      asked.refuse(error.what());
    }
  }
}

/// Throws std::invalid_argument if layers of the scene's cloths cannot be held apart.
void checkLayers(const Scene& scene) {
  checkLayers(findSolver(scene.solver.method));
  for (const ClothSpec& cloth : scene.cloths) {
    if (cloth.fabric.thickness > 0.0) continue;
    throw std::invalid_argument("the fabric of cloth '" + cloth.name +
                                "' has no thickness; layers need one");
  }
}

/// Decides whether layers touch each other: if the scene says so; by default those of several
/// cloths, where they can be held apart.
void chooseLayers(const SceneNode& root, Scene& scene) {
  if (!root.has("self_contact")) scene.selfContact = scene.cloths.size() > 1;
  if (scene.selfContact) {
    try {
      checkLayers(scene);
    } catch (const std::invalid_argument& error) {
      if (root.has("self_contact")) root.need("self_contact", "true or false").refuse(error.what());
      scene.selfContact = false;
      scene.noLayers = error.what();
    }
  }
  const auto contact = root.find("contact");
  if (!scene.selfContact && contact && contact->has("start")) {
    contact->refuse("expected self_contact: true beside it");
  }
}

/// Tells whether the scene says how far springs stretch before they fail.
bool givesRatio(const Scene& scene) {
  const auto has = [](const PhaseSpec& phase) { return phase.ratio.has_value(); };
  return scene.tearing.ratio != infiniteRatios() ||
         std::any_of(scene.phases.begin(), scene.phases.end(), has);
}

/// Returns the first tear energy that a cloth of the scene is given, if any.
std::optional<SceneNode> givenTearEnergy(const SceneNode& root) {
  for (const SceneNode& cloth : clothNodes(root.need("cloth", "a map"))) {
    const auto fabric = cloth.find("fabric");
    const auto energy = fabric && fabric->isMap() ? fabric->find("tear_energy") : std::nullopt;
    if (energy) return energy;
  }
  return std::nullopt;
}

/// Chooses the criterion by which the cloths tear: that of `tearing.by`, or else energy if a cloth
/// is given a tear energy. Refuses what the other criterion needs.
void chooseTearing(const SceneNode& root, Scene& scene) {
  const auto tearing = root.find("tearing");
  if (!tearing) return;
  const auto by = tearing->find("by");
  const auto given = givenTearEnergy(root);
  const bool byEnergy =
      by ? by->choice<bool>({{"energy", true}, {"stretch", false}}) : given.has_value();
  if (!byEnergy) {
    if (given) given->refuse("expected only where cloth tears by energy");
    return;
  }
  const SceneNode asked = by ? *by : *given;
  if (givesRatio(scene)) asked.refuse("expected either an energy or a tearing.ratio, not both");
  try {
    checkTearEnergy(findSolver(scene.solver.method));
  } catch (const std::invalid_argument& error) {
    asked.refuse(error.what());
  }
  for (const ClothSpec& cloth : scene.cloths) {
    scene.tearing.energy.push_back(cloth.fabric.tearEnergy);
  }
}

/// Returns the scene as it runs here, as YAML. It names the method that `auto` chose, because
/// another machine may choose another one.
std::string textOf(const Scene& scene, YamlValue tree) {
  if (!scene.solver.choice) return emitYaml(tree);
  const auto set = [&](const std::string& key, const std::string& value) {
    applyOverride("solver." + key + "=" + value, scene.name, tree);
  };
  char number[32];
  const auto setNumber = [&](const std::string& key, double value) {
    std::snprintf(number, sizeof number, "%.17g", value);
    set(key, number);
  };
  set("error", "null");
  set("method", scene.solver.method);
  setNumber("dt", scene.solver.dt);
  for (const auto& [name, value] : scene.solver.parameters) setNumber(name, value);
  return emitYaml(tree);
}

/// Says which clamps and obstacles overrides have added, because a misspelt name adds one; "" for
/// none.
std::string describeAdded(const YamlValue& tree) {
  std::string text;
  for (const std::string section : {"clamps", "obstacles"}) {
    const YamlValue* const map = tree.find(section);
    if (map == nullptr || map->kind != YamlValue::Kind::kMap) continue;
    const auto isAdded = [](const YamlValue& item) { return item.overridden && item.keyLine == 0; };
    std::vector<std::string> others;
    for (const YamlValue& item : map->items) {
      if (!isAdded(item)) others.push_back(item.key);
    }
    if (others.empty()) continue;
    for (const YamlValue& item : map->items) {
      if (!isAdded(item)) continue;
      text += "; an override has added " + section + "." + shownText(item.key) + " beside " +
              joinNames(others);
    }
  }
  return text;
}

/// \param tree  with all overrides.
Scene readTree(YamlValue& tree, const std::string& name) {
  dropOtherParameters(tree);
  const SceneNode root(tree, "", name);
  Scene scene = readScene(root);
  scene.name = sceneName(name);
  scene.contentKey = contentKey(tree, scene.solver.dt);
  chooseBending(root, scene);
  resolve(root, scene);
  checkFeatures(root, scene);
  checkBendFriction(root, scene);
  chooseLayers(root, scene);
  chooseTearing(root, scene);
  scene.text = textOf(scene, tree);
  return scene;
}

}  // namespace

std::vector<KeyTable> sceneKeys() {
  std::vector<KeyTable> tables{kSceneSection.keys(), kContactSection.keys()};
  for (const auto list : {listCommonKeys, listClothKeys, listSurgeryKeys, listSolverKeys,
                          listObstacleKeys, listClampKeys, listTearingKeys, listPhaseKeys}) {
    list(tables);
  }
  return tables;
}

SceneError::SceneError(const std::string& text) : std::runtime_error(oneLine(text)) {}

Scene loadScene(const std::string& path, const std::vector<std::string>& overrides) {
  return parseScene(readFile(path), path, overrides);
}

Scene parseScene(const std::string& yaml, const std::string& name,
                 const std::vector<std::string>& overrides) {
  YamlValue tree = parseYaml(yaml, name);
  for (const std::string& text : overrides) applyOverride(text, name, tree);
  try {
    return readTree(tree, name);
  } catch (const SceneError& error) {
    throw SceneError(error.what() + describeAdded(tree));
  }
}

}  // namespace cloth_sim
