#include "fuzz/fuzz_targets.h"

#include <cstring>
#include <filesystem>
#include <memory>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/saved_state.h"
#include "cloth_sim/sim/simulation.h"
#include "determinism/busy_scene.h"
#include "scene/dae_mesh.h"
#include "scene/obj_mesh.h"
#include "scene/surface_reader.h"
#include "sim/command_text.h"
#include "sim/state_format.h"
#include "support/input_file.h"

namespace cloth_sim::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr int kParticles = 10;               ///< along each side of the cloths here
constexpr std::size_t kMostParticles = 400;  ///< of a scene that is run
constexpr double kMostSubsteps = 200.0;      ///< of a scene that is run

void expect(bool holds, const std::string& what) {
  if (!holds) throw Misbehaviour(what);
}

void expectOneLine(const std::string& message) {
  expect(!message.empty() && message.find('\n') == std::string::npos,
         "a refusal is not one line: '" + message + "'");
}

/// Steps, and looks at everything that others may see.
void run(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) {
    simulation.step();
    expect(isFinite(simulation.state()), "not finite after step " + std::to_string(k) + " of " +
                                             std::to_string(steps) + ", " + simulation.failure());
  }
  expect(isFinite(simulation.state()), "not finite after commands");
  if (simulation.failed()) expectOneLine(simulation.failure());
  simulation.observeMaxStretch();
  simulation.snapshot();
  expect(validationError(simulation.model().mesh).empty(), "the mesh is not valid");
}

// ---- saved states -----------------------------------------------------------------------------

/// A scene whose states are saved: after cuts and tears, with clamps that hold.
struct StateScene {
  Scene scene;
  std::string origin;  ///< the beginning of the payload, which names the scene
  std::string rest;    ///< of the payload
};

void disturb(Simulation& simulation) {
  const Stroke across = strokeAlong({{-1, 0.13, 0}, {1, 0.27, 0}}, Vec3(0.0, 0.0, -1.0), 1.0);
  simulation.apply(CutAlong{across});
  simulation.apply(RefineMesh{{{Vec3(0.2, 0.2, 0.2)}, {0.1, 2, 0.0}}});
  simulation.apply(SetGripForce{"right", 0.05});
  simulation.apply(SetStiffness{1.1});
  ClampSpec more;
  more.name = "more";
  simulation.apply(CreateClamp{more});
  simulation.apply(PullParticle{true, Ray{Vec3(0.1, 0.1, 1.0), -Vec3::UnitZ()}});
}

/// Returns the scene with raw springs instead of a fabric, which have data of their own.
Scene withRawSprings(const Scene& scene) {
  return parseScene(scene.text, "raw.yaml",
                    {"cloth.fabric=null", "cloth.bending=springs",
                     "cloth.raw_springs={structural: 50, shear: 20, bend: 5}"});
}

StateScene makeStateScene(Scene scene) {
  StateScene made;
  made.scene = std::move(scene);
  Simulation simulation(made.scene);
  run(simulation, 12);
  disturb(simulation);
  run(simulation, 6);
  const std::string payload = unsealState(simulation.save());
  // A byte order, the text and its length, a hash, the method and its length.
  const std::size_t origin =
      1 + 8 + made.scene.text.size() + 8 + 8 + made.scene.solver.method.size();
  made.origin = payload.substr(0, origin);
  made.rest = payload.substr(origin);
  return made;
}

const std::vector<StateScene>& stateScenes() {
  static const std::vector<StateScene> scenes = [] {
    std::vector<StateScene> made;
    for (const char* method : {"line_xpbd", "xpbd", "projective", "verlet"}) {
      made.push_back(makeStateScene(testing_support::busyScene(method, kParticles)));
    }
    made.push_back(makeStateScene(withRawSprings(testing_support::busyScene("xpbd", kParticles))));
    return made;
  }();
  return scenes;
}

/// \param bytes  number of the scene, and what follows its name in a payload.
bool feedState(const std::string& bytes) {
  if (bytes.empty()) return false;
  const std::size_t k = static_cast<unsigned char>(bytes[0]) % stateScenes().size();
  const StateScene& from = stateScenes()[k];
  static std::vector<std::unique_ptr<Simulation>> fresh(stateScenes().size());
  if (!fresh[k]) fresh[k] = std::make_unique<Simulation>(from.scene);
  Simulation& simulation = *fresh[k];
  try {
    const SimulationParts like(from.scene);
    const SimulationParts parts =
        loadPayload(from.origin + bytes.substr(1), like, StateHash::kIgnored);
    simulation.load(saveParts(parts));
    expect(isFinite(simulation.state()), "not finite as it was loaded");
  } catch (const StateError& error) {
    expectOneLine(error.what());
    return false;
  }
  run(simulation, 3);
  disturb(simulation);
  run(simulation, 2);
  return true;
}

std::vector<std::string> stateSeeds() {
  std::vector<std::string> seeds;
  for (const StateScene& scene : stateScenes()) {
    seeds.push_back(std::string(1, static_cast<char>(seeds.size())) + scene.rest);
  }
  return seeds;
}

// ---- scenes -----------------------------------------------------------------------------------

bool isSmall(const Scene& scene) {
  std::size_t particles = 0;
  for (const ClothSpec& cloth : scene.cloths) {
    particles +=
        cloth.mesh ? cloth.mesh->material.size()
                   : static_cast<std::size_t>(cloth.columns) * static_cast<std::size_t>(cloth.rows);
  }
  for (const auto& [name, value] : scene.solver.parameters) {
    if ((name == "substeps" || name == "iterations") && value > kMostSubsteps) return false;
  }
  return particles <= kMostParticles;
}

bool feedScene(const std::string& bytes) {
  try {
    const Scene scene = parseScene(bytes, CLOTH_SIM_SOURCE_DIR "/config/scenes/fuzz.yaml");
    if (!isSmall(scene)) return true;
    Simulation simulation(scene);
    run(simulation, 2);
    return true;
  } catch (const Misbehaviour&) {
    throw;
  } catch (const SceneError& error) {
    expectOneLine(error.what());
  } catch (const std::invalid_argument& error) {  // of a scene that contradicts itself
    expectOneLine(error.what());
  } catch (const std::runtime_error& error) {
    expectOneLine(error.what());
  }
  return false;
}

std::vector<std::string> sceneSeeds() {
  std::vector<std::string> seeds;
  for (const auto& entry : fs::directory_iterator(CLOTH_SIM_SOURCE_DIR "/config/scenes")) {
    if (entry.path().extension() == ".yaml") seeds.push_back(entry.path().string());
  }
  std::sort(seeds.begin(), seeds.end());
  for (std::string& seed : seeds) seed = readInputFile(seed, {});
  seeds.push_back(testing_support::busyScene("xpbd", kParticles).text);
  return seeds;
}

// ---- meshes -----------------------------------------------------------------------------------

bool feedObj(const std::string& bytes) {
  try {
    const ClothMesh mesh = parseObj(bytes, "fuzz.obj", ObjUnits());
    expect(validationError(TriangleMesh(mesh.material, mesh.faces)).empty(),
           "a mesh was accepted that is not valid");
    return true;
  } catch (const SceneError& error) {
    expectOneLine(error.what());
    return false;
  }
}

std::vector<std::string> objSeeds() {
  return {
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n",
      "# a fan\no cloth\nv 0 0 0\nv 1 0 0\nv 2 0.5 0.1\nv 1 1 0\nv 0 1 0\n"
      "vt 0.0 0.0\nvt 1.0 0.0\nvt 2.0 0.5\nvt 1.0 1.0\nvt 0.0 1.0\nvn 0 0 1\n"
      "usemtl a\nf 1/1/1 2/2/1 3/3/1 4/4/1 5/5/1\n",
      "v 0 0 0\nv 1e-3 0 0\nv 0 1e3 0\nvt 0 0\nvt 0 1\nvt 1 0\nf -3/-3 -2/-2 -1/-1\n"};
}

// ---- meshes of obstacles ----------------------------------------------------------------------

/// Asks for distances and sweeps near a surface: all finite, and no path ends too far away.
void probe(const TriangleSurface& surface) {
  const Vec3 size = surface.high() - surface.low();
  const Vec3 middle = 0.5 * (surface.low() + surface.high());
  const double reach = 1e-3 * size.norm();
  for (const Vec3& from : {middle, surface.low(), surface.vertices().front(), Vec3(Vec3::Zero()),
                           Vec3(middle + Vec3(1e3, -2e3, 3e3))}) {
    Vec3 normal = Vec3::Zero();
    const double distance = surface.distance(from, normal);
    expect(std::isfinite(distance), "a distance is not finite");
    expect(std::abs(normal.norm() - 1.0) < 1e-6, "a normal is no unit vector");
    NearTriangles near;
    SurfaceHit hit;
    if (!surface.sweep(from, middle + 0.7 * size, reach, reach, near, hit)) continue;
    expect(std::isfinite(hit.push) && hit.push > 0.0, "a push is not finite and > 0");
    expect(std::abs(hit.normal.norm() - 1.0) < 1e-6, "a normal of a hit is no unit vector");
  }
}

/// \param bytes  o for OBJ, d for DAE, anything else for STL; then the contents of the file.
bool feedSurface(const std::string& bytes) {
  if (bytes.empty()) return false;
  try {
    const std::string file = bytes.substr(1);
    Triangles triangles = bytes[0] == 'o'   ? parseObjTriangles(file, "fuzz.obj")
                          : bytes[0] == 'd' ? parseDae(file, "fuzz.dae")
                                            : parseStl(file, "fuzz.stl");
    probe(TriangleSurface(std::move(triangles.vertices), triangles.corners));
    return true;
  } catch (const SceneError& error) {
    expectOneLine(error.what());
  } catch (const std::invalid_argument& error) {  // of the surface
    expectOneLine(error.what());
  }
  return false;
}

/// A tetrahedron as a binary STL file.
std::string binaryStl() {
  const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  std::string file(80, ' ');
  file += std::string("\4\0\0\0", 4);
  for (const auto& face : faces) {
    file += std::string(12, '\0');  // the normal
    for (const int k : face) file.append(reinterpret_cast<const char*>(corners[k]), 12);
    file += std::string(2, '\0');
  }
  return file;
}

std::vector<std::string> surfaceSeeds() {
  return {
      "s" + binaryStl(),
      // NOLINTNEXTLINE(bugprone-suspicious-missing-comma): one file in several lines
      "ssolid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n"
      "   vertex 0 1 0\n  endloop\n endfacet\n facet normal 0 0 1\n  outer loop\n"
      "   vertex 1 0 0\n   vertex 1 1 0.5\n   vertex 0 1 0\n  endloop\n endfacet\n"
      "endsolid a\n",
      "d<COLLADA><asset><unit meter='0.5'/></asset><library_geometries><geometry id='g'><mesh>"
      "<source id='s'><float_array>0 0 0 1 0 0 1 1 0 0 1 1</float_array><technique_common>"
      "<accessor stride='3'/></technique_common></source><vertices id='v'><input "
      "semantic='POSITION' source='#s'/></vertices><polylist><input semantic='VERTEX' "
      "source='#v' offset='0'/><vcount>4 3</vcount><p>0 1 2 3 0 3 2</p></polylist></mesh>"
      "</geometry></library_geometries><library_visual_scenes><visual_scene id='a'><node id='n'>"
      "<translate>1 2 3</translate><rotate>0 0 1 30</rotate><instance_geometry url='#g'/>"
      "</node><node><scale>2 2 2</scale><instance_node url='#n'/></node></visual_scene>"
      "</library_visual_scenes><scene><instance_visual_scene url='#a'/></scene></COLLADA>",
      "ov 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\nf 4 3 2 1\nf 1 2 5\nf 2 3 5\n"
      "f 3 4 5\nf 4 1 5\n",
      "o# open\nv 0 0 0\nv 1e-3 0 0\nv 0 1e3 0\nv 2 2 2\nf 1/1/1 2//2 3\nf -1 -2 -3\n"};
}

// ---- strokes and commands ---------------------------------------------------------------------

Scene flatScene() {
  return parseScene(
      "cloth: {size: [0.5, 0.5], particles: [8, 8], pose: {position: [0, 0, 0.2]}, fabric: cotton,"
      " pins: [corner_00]}\n"
      "solver: {method: xpbd, dt: 0.01, substeps: 4}\n"
      "obstacles: {ground: {type: plane}}\n"
      "clamps: {left: {pose: {position: [0.1, 0.1, 0.2]}}}\n"
      "phases: [{name: fall, timeout: 1.0}]\n",
      "flat.yaml");
}

/// \param bytes  half-width, then heel and tip of each pose, as numbers of 8 bytes.
bool feedStroke(const std::string& bytes) {
  std::vector<double> numbers(std::min<std::size_t>(bytes.size() / sizeof(double), 61));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(double));
  Stroke stroke;
  if (!numbers.empty()) stroke.halfWidth = numbers[0];
  for (std::size_t k = 1; k + 6 <= numbers.size(); k += 6) {
    const double* p = numbers.data() + k;
    stroke.poses.push_back({Vec3(p[0], p[1], p[2]), Vec3(p[3], p[4], p[5])});
  }
  static const Scene scene = flatScene();
  Simulation simulation(scene);
  const double mass = totalMass(simulation.model());
  const CommandResult result = simulation.apply(CutAlong{stroke});
  if (!result.success) expectOneLine(result.message);
  expect(std::abs(totalMass(simulation.model()) - mass) <= 1e-12 * mass, "a cut loses mass");
  run(simulation, 1);
  return result.success;
}

std::vector<std::string> strokeSeeds() {
  const auto bytesOf = [](const std::vector<double>& numbers) {
    return std::string(reinterpret_cast<const char*>(numbers.data()),
                       numbers.size() * sizeof(double));
  };
  return {bytesOf({0, -1, 0.01, 0, -1, 0.01, 1, 1, 0.02, 0, 1, 0.02, 1}),
          bytesOf({0.02, -0.2, -0.1, 0, -0.2, -0.1, 1, 0, 0.1, 0, 0, 0.1, 1, 0.2, -0.1, 0, 0.2,
                   -0.1, 1}),
          bytesOf({0, 0,   0, 0,   0, 0, 1, 0.1, 0, 0, 0.1, 0.1, 1,
                   0, 0.1, 0, 0.1, 0, 1, 0, 0,   0, 0, 0,   1})};
}

/// \param bytes  of a command, as a bag has it.
bool feedCommand(const std::string& bytes) {
  static const Scene scene = flatScene();
  try {
    Simulation simulation(scene);
    run(simulation, 1);
    const CommandResult result = simulation.apply(unpackCommand(bytes));
    if (!result.success) expectOneLine(result.message);
    run(simulation, 2);
    return result.success;
  } catch (const StateError& error) {
    expectOneLine(error.what());
    return false;
  }
}

std::vector<std::string> commandSeeds() {
  Simulation simulation(flatScene());
  run(simulation, 3);
  const Pose aside{Vec3(0.05, 0.0, 0.1)};
  ClampSpec more;
  more.name = "more";
  std::vector<std::string> seeds;
  for (const Command& command : std::vector<Command>{
           SetClampTarget{"left", aside}, GuideClamp{"left", {aside, Vec3::UnitX(), {}, 0.1}},
           SetGripForce{"left", 2.0}, SetGapWidth{"left", 0.01}, CreateClamp{more},
           DeleteClamp{"left"}, SetGrasp{"left", true}, SetPhase{"fall"},
           SetGravity{Vec3(0.0, 0.0, -3.0)}, MoveObstacle{"ground", aside, Vec3::Zero()},
           SetTearing{true, {1.15, 1.3, 1.4}}, SetWind{Wind()}, SetStiffness{1.1},
           SetQuasiStatic{true}, CutAlong{strokeAlong({{-1, 0, 0}, {1, 0, 0}}, Vec3::UnitZ(), 1.0)},
           RefineMesh{{{Vec3(0.0, 0.0, 0.2)}, {0.1, 2, 0.0}}}, Reset{ResetScope::kState},
           Restore{simulation.save()}}) {
    seeds.push_back(packCommand(command));
  }
  return seeds;
}

}  // namespace

const std::vector<Target>& targets() {
  static const std::vector<Target> all{
      {"state", feedState, stateSeeds},    {"scene", feedScene, sceneSeeds},
      {"obj", feedObj, objSeeds},          {"surface", feedSurface, surfaceSeeds},
      {"stroke", feedStroke, strokeSeeds}, {"command", feedCommand, commandSeeds}};
  return all;
}

const Target& findTarget(const std::string& name) {
  for (const Target& target : targets()) {
    if (name == target.name) return target;
  }
  throw std::invalid_argument("no fuzz target '" + name + "'");
}

}  // namespace cloth_sim::fuzz
