#include "cloth_sim/sim/simulation_parts.h"

#include "cloth_sim/scene/build.h"

namespace cloth_sim {

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
