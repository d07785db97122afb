#include "cloth_sim/sim/simulation_parts.h"

#include <sstream>
#include <stdexcept>

#include "cloth_sim/scene/build.h"
#include "contact/untangle.h"
#include "mesh/quality.h"

namespace cloth_sim {
namespace {

/// Number of the warning about thick layers, beyond those of ResultWatch.
constexpr std::size_t kThickLayer = 100;
/// Number of the warning about obstacles that are nearly closed.
constexpr std::size_t kNearlyClosed = 101;
/// Number of the warning about cloth that was opened up.
constexpr std::size_t kOpenedUp = 102;
/// Number of the warning about cloths that pass through each other.
constexpr std::size_t kPassThrough = 103;
/// Most motion of a vertex in a pass that opens cloth up, over the shortest edge [-].
constexpr double kUntangleStep = 0.1;

/// Warns of obstacles whose surface is nearly closed.
void checkSurfaces(SimulationParts& parts) {
  for (const Obstacle& obstacle : parts.scene.obstacles) {
    const auto* mesh = std::get_if<MeshShape>(&obstacle.shape);
    if (mesh == nullptr || mesh->file.surface->doubt().empty()) continue;
    const std::string text = "obstacle '" + obstacle.name + "': " + mesh->file.surface->doubt();
    parts.sceneWarnings.push_back({kNearlyClosed, text});
  }
}

std::string pairsText(std::size_t pairs) {
  return std::to_string(pairs) + (pairs == 1 ? " pair" : " pairs") + " of faces";
}

/// Opens up cloth that touches or intersects itself.
Untangled openUp(const Scene& scene, const Model& model, LayerContact& layers, State& state) {
  UntangleOptions options;
  options.step = kUntangleStep * shortestEdge(model.mesh);
  options.isHeld.assign(state.x.values().size(), 0);
  for (const KinematicTarget& pin : pinTargets(scene.cloths, model, state)) {
    options.isHeld[pin.vertex] = 1;
  }
  std::vector<Vec3> x = state.x.values();
  const auto overlap = [&](const std::vector<Vec3>& at) {
    return layers.findOverlap(model, at).pairs;
  };
  const Untangled result = untangle(model.mesh, options, overlap, x);
  for (VertexId v = 0; v < model.particleCount(); ++v) state.x[v] = x[v];
  return result;
}

/// Returns the state at the start. Cloth that touches or intersects itself is opened up, with a
/// warning, if the scene asks for that; otherwise it is refused.
State startState(const Scene& scene, const Model& model, LayerContact* layers,
                 std::vector<ResultWarning>& warnings) {
  State state = initialState(scene.cloths, model, scene.seed);
  if (layers == nullptr) return state;
  checkLayers(findSolver(scene.solver.method));
  const LayerOverlap overlap = layers->findOverlap(model, state.x.values());
  if (overlap.pairs.empty()) return state;
  std::ostringstream text;
  text << "self_contact: the cloth touches or intersects itself at the start, in "
       << pairsText(overlap.pairs.size()) << ", the first at (" << overlap.place.x() << ", "
       << overlap.place.y() << ", " << overlap.place.z() << ")";
  if (scene.startContact == StartContact::kUntangle) {
    const Untangled result = openUp(scene, model, *layers, state);
    if (result.left == 0) {
      text << "; it was opened up, by moving particles by up to " << result.farthest << " m";
      warnings.push_back({kOpenedUp, text.str()});
      return state;
    }
    text << "; `untangle` leaves " << pairsText(static_cast<std::size_t>(result.left));
  } else {
    text << "; contact: {start: untangle} may open it up, self_contact: false leaves it so";
  }
  throw std::invalid_argument(text.str());
}

/// Warns of cloth that is too thick for its mesh.
void checkThickness(SimulationParts& parts) {
  const double most = thickestLayer(parts.model);
  for (const ClothSpec& cloth : parts.scene.cloths) {
    if (cloth.fabric.thickness <= most) continue;
    std::ostringstream text;
    text << "the fabric of cloth '" << cloth.name << "' is thicker (" << cloth.fabric.thickness
         << " m) than half of the shortest edge: its layers keep " << most << " m apart instead";
    parts.sceneWarnings.push_back({kThickLayer, text.str()});
  }
}

}  // namespace

SimulationParts::SimulationParts(Scene loaded)
    : scene(std::move(loaded)),
      model(buildModel(scene.cloths)),
      layers(buildLayers(scene, model)),
      state(startState(scene, model, layers.get(), sceneWarnings)),
      holders(pinTargets(scene.cloths, model, state), scene.clamps),
      obstacles(buildColliders(scene)),
      solver(scene.solver, model, state),
      surgery(scene.surgery, scene.tearing, model),
      script(scene.phases),
      sleep(scene.solver.sleep),
      watch(findSolver(scene.solver.method)),
      startHash(stateHash(model, state)) {
  controls.gravity = scene.gravity;
  controls.drag = scene.drag;
  controls.quasiStatic = scene.quasiStatic;
  controls.wind = scene.wind;
  if (!scene.tearing.energy.empty()) checkTearEnergy(findSolver(scene.solver.method));
  if (layers) checkThickness(*this);
  if (!scene.noLayers.empty()) {
    sceneWarnings.push_back({kPassThrough, "cloths pass through each other: " + scene.noLayers});
  }
  checkSurfaces(*this);
}

std::vector<ResultWarning> SimulationParts::warnings() const {
  std::vector<ResultWarning> all = sceneWarnings;
  for (ResultWarning& warning : watch.warnings()) all.push_back(std::move(warning));
  return all;
}

Tuning SimulationParts::tuning() const {
  Tuning now;
  now.gravity = controls.gravity;
  now.wind = controls.wind;
  now.tearing = surgery.tearing().settings().enabled;
  now.ratio = surgery.tearing().settings().ratio;
  now.quasiStatic = controls.quasiStatic;
  now.stiffness = model.springs.scale();
  return now;
}

bool SimulationParts::isStill() const {
  return holders.areStill() && !surgery.tearing().isOverloaded() &&
         obstacles.areStill(time(), dt());
}

void SimulationParts::shiftTime(double by) {
  state.t += by;
  obstacles.shiftTime(by);
  script.shiftTime(by);
  surgery.tearing().shiftTime(by);
  holders.drag().shiftTime(by);
}

}  // namespace cloth_sim
