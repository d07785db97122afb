#include "cloth_sim/sim/simulation_parts.h"

#include <sstream>
#include <stdexcept>

#include "cloth_sim/scene/build.h"

namespace cloth_sim {
namespace {

/// Number of the warning about thick layers, beyond those of ResultWatch.
constexpr std::size_t kThickLayer = 100;
/// Number of the warning about obstacles that are nearly closed.
constexpr std::size_t kNearlyClosed = 101;

/// Warns of obstacles whose surface is nearly closed.
void checkSurfaces(SimulationParts& parts) {
  for (const Obstacle& obstacle : parts.scene.obstacles) {
    const auto* mesh = std::get_if<MeshShape>(&obstacle.shape);
    if (mesh == nullptr || mesh->file.surface->doubt().empty()) continue;
    const std::string text = "obstacle '" + obstacle.name + "': " + mesh->file.surface->doubt();
    parts.sceneWarnings.push_back({kNearlyClosed, text});
  }
}

/// Refuses a method that cannot hold layers apart and cloth that touches itself at the start, and
/// warns of cloth that is too thick for its mesh.
void prepareLayers(SimulationParts& parts) {
  checkLayers(findSolver(parts.scene.solver.method));
  const LayerOverlap overlap = parts.layers->findOverlap(parts.state.x.values());
  if (overlap.pairs > 0) {
    std::ostringstream text;
    text << "self_contact: the cloth touches or intersects itself at the start, in "
         << overlap.pairs << (overlap.pairs == 1 ? " pair" : " pairs")
         << " of faces, the first at (" << overlap.place.x() << ", " << overlap.place.y() << ", "
         << overlap.place.z() << ")";
    throw std::invalid_argument(text.str());
  }
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
      state(initialState(scene.cloths, model, scene.seed)),
      holders(pinTargets(scene.cloths, model, state), scene.clamps),
      obstacles(buildColliders(scene)),
      layers(buildLayers(scene, model)),
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
  if (layers) prepareLayers(*this);
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
