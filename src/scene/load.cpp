#include "cloth_sim/scene/load.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "keys.h"
#include "readers.h"

namespace cloth_sim {

namespace {

constexpr std::streamoff kMaxFileSize = 16 << 20;  // [bytes]

/// "config/scenes/hang.yaml" -> "hang".
std::string sceneName(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  const std::string file = slash == std::string::npos ? path : path.substr(slash + 1);
  return file.substr(0, file.find_last_of('.'));
}

std::string readFile(const std::string& path) {
  errno = 0;
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  if (!stream) {
    const std::string reason = errno != 0 ? std::strerror(errno) : "not readable";
    throw SceneError(path + ": cannot read the file (" + reason + ")");
  }
  const std::streamoff size = stream.tellg();
  if (size < 0 || size > kMaxFileSize) {
    throw SceneError(path + ": expected a scene file of at most 16 MiB");
  }
  std::string text(static_cast<std::size_t>(size), '\0');
  stream.seekg(0);
  stream.read(&text[0], size);
  if (!stream) throw SceneError(path + ": cannot read the file");
  return text;
}

void readSurroundings(const SceneNode& root, Scene& scene) {
  root.read("gravity", scene.gravity);
  root.read("drag", scene.drag, kNotNegative);
  if (const auto wind = root.find("wind")) scene.wind = readWind(*wind);
  if (const auto seed = root.find("seed")) scene.seed = seed->seed();
}

Scene readScene(const SceneNode& root) {
  root.expectKeys(keys::kScene);
  Scene scene;
  readCloth(root.need("cloth", "a map"), scene.cloth);
  if (const auto solver = root.find("solver")) {
    readSolver(*solver, scene.solver);
  } else {
    scene.solver.parameters = completeParameters(findSolver(scene.solver.method), {});
  }
  try {
    checkFeatures(findSolver(scene.solver.method), scene.cloth.hinge);
  } catch (const std::invalid_argument& error) {
    root.need("cloth", "a map").need("bending", "a word").refuse(error.what());
  }
  readSurroundings(root, scene);
  if (const auto obstacles = root.find("obstacles")) {
    readObstacles(*obstacles, scene.cloth.fabric.friction, scene.obstacles);
  }
  if (const auto clamps = root.find("clamps")) readClamps(*clamps, scene.cloth, scene.clamps);
  if (const auto tearing = root.find("tearing")) readTearing(*tearing, scene.cloth, scene.tearing);
  if (const auto phases = root.find("phases")) readPhases(*phases, scene, scene.phases);
  return scene;
}

}  // namespace

Scene loadScene(const std::string& path, const std::vector<std::string>& overrides) {
  return parseScene(readFile(path), path, overrides);
}

Scene parseScene(const std::string& yaml, const std::string& name,
                 const std::vector<std::string>& overrides) {
  YamlValue tree = parseYaml(yaml, name);
  for (const std::string& text : overrides) applyOverride(text, name, tree);
  Scene scene = readScene(SceneNode(tree, "", name));
  scene.name = sceneName(name);
  return scene;
}

}  // namespace cloth_sim
