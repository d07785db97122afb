#include "scenes.h"

#include <sstream>

#include "cloth_sim/scene/load.h"

namespace cloth_sim::bench {
namespace {

std::string clothOf(int n, const std::string& rest) {
  std::ostringstream out;
  out << "cloth:\n  particles: [" << n << ", " << n
      << "]\n  fabric: {preset: cotton, areal_density: 0.2}\n"
      << rest;
  return out.str();
}

std::string solverOf(const std::string& method) {
  return "solver: {sleep: false, method: " + method + "}\n";
}

}  // namespace

Scene hanging(int n, const std::string& method, const std::string& bending) {
  return parseScene(clothOf(n,
                            "  pose: {position: [0, 0, 1], rpy: [1.5707963267948966, 0, 0]}\n"
                            "  pins: [corner_01, corner_11]\n  bending: " +
                                bending + "\n") +
                        "drag: 0.5\n" + solverOf(method),
                    "hanging");
}

Scene overSphere(int n, const std::string& method) {
  return parseScene(clothOf(n, "  bending: springs\n  pose: {position: [0, 0, 0.27]}\n") +
                        "drag: 0.5\n" + solverOf(method) +
                        "obstacles:\n  ball: {type: sphere, radius: 0.25, position: [0, 0, 0]}\n",
                    "over a sphere");
}

Scene refinedWhenCut(Scene scene) {
  scene.surgery.refineCuts = Refinement{0.02, 2, 0.0};
  return scene;
}

void cutSlits(Simulation& simulation) {
  for (const double height : {0.3, 0.5, 0.7}) {
    const std::vector<Vec3> path = {{-0.3, 0.0, height + 0.5}, {0.3, 0.0, height + 0.53}};
    const CommandResult result = simulation.apply(CutAlong{strokeAlong(path, Vec3::UnitY(), 0.5)});
    if (!result.success) throw std::runtime_error(result.message);
  }
}

Warm::Warm(Scene scene, int steps) : Warm(std::make_unique<Simulation>(std::move(scene)), steps) {}

Warm::Warm(std::unique_ptr<Simulation> simulation, int steps) : simulation_(std::move(simulation)) {
  for (int k = 0; k < steps; ++k) simulation_->step();
  bytes_ = simulation_->save();
}

void Warm::goBack() {
  simulation_->load(bytes_);
  simulation_->step();
}

void timeSteps(Warm& warm, int stretch, benchmark::State& run) {
  Simulation& simulation = warm.simulation();
  int since = 0;
  for (auto _ : run) {
    if (since++ == stretch) {
      run.PauseTiming();
      warm.goBack();
      since = 1;
      run.ResumeTiming();
    }
    simulation.step();
  }
  if (simulation.failed()) run.SkipWithError(simulation.failure().c_str());
}

void tellPerSpring(double springs, benchmark::State& run) {
  run.counters["per_spring"] = benchmark::Counter(
      springs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

}  // namespace cloth_sim::bench
