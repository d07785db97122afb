// Steps of a whole scene: held by clamps, over a ground, with tearing armed, and after cuts.

#include <benchmark/benchmark.h>

#include <map>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/threads/thread_limit.h"
#include "scenes.h"

namespace cloth_sim::bench {
namespace {

constexpr int kSide = 128;
/// Steps until the clamps have closed and what a cut set off is over.
constexpr int kWarmUp = 40;
/// Steps from one return to the state after the warm-up to the next: each run takes all of them, as
/// some are divided where a spring is near failing.
constexpr int kStretch = 20;

/// As `hanging`, with clamps in place of pins, a ground and a ball in reach, and tearing armed.
/// \param method  and its parameters, as in the scene.
Scene armed(const std::string& method, const std::string& refinement) {
  const auto clamp = [](const std::string& name, const std::string& column, const std::string& x) {
    return "  " + name + ":\n    patch: {particle: [" + column +
           ", 127], radius: 1}\n    pose: {position: [" + x +
           ", 0, 1.5], rpy: [1.5707963267948966, 0, 0]}\n    gap_open: 0.021\n";
  };
  return parseScene(
      "cloth:\n  particles: [128, 128]\n  fabric: {preset: cotton, areal_density: 0.2}\n"
      "  pose: {position: [0, 0, 1], rpy: [1.5707963267948966, 0, 0]}\n" +
          refinement + "clamps:\n" + clamp("left", "0", "-0.5") + clamp("right", "127", "0.5") +
          "phases: [{name: all, clamps: {all: {grasp: true}}}]\n"
          "obstacles:\n  ground: {type: plane}\n"
          "  ball: {type: sphere, radius: 0.2, position: [0, 0.21, 0.5]}\n"
          "tearing: {ratio: 10}\ndrag: 0.5\nsolver: {sleep: false, method: " +
          method + "}\n",
      "armed");
}

/// Three slits from side to side of the middle.
void cutSlits(Simulation& simulation) {
  for (const double height : {0.3, 0.5, 0.7}) {
    const std::vector<Vec3> path = {{-0.3, 0.0, height + 0.5}, {0.3, 0.0, height + 0.53}};
    const CommandResult result = simulation.apply(CutAlong{strokeAlong(path, Vec3::UnitY(), 0.5)});
    if (!result.success) throw std::runtime_error(result.message);
  }
}

void step(benchmark::State& run, const Scene& scene, bool isCut) {
  const ThreadLimit limit(1);
  auto begun = std::make_unique<Simulation>(scene);
  begun->step();
  if (isCut) cutSlits(*begun);
  Warm warm(std::move(begun), kWarmUp);
  timeSteps(warm, kStretch, run);
  const Simulation& simulation = warm.simulation();
  const double springs = simulation.model().springs.count();
  tellPerSpring(springs, run);
  run.counters["particles"] = simulation.model().particleCount();
}

const bool registered = [] {
  const std::string refined = "  surgery: {refine_cuts: {radius: 0.02, generations: 2}}\n";
  const std::map<std::string, std::string> settings = {
      {"xpbd", "xpbd"}, {"projective", "projective, substeps: 1, iterations: 1"}};
  for (const auto& [method, setting] : settings) {
    const auto add = [&](const std::string& name, const Scene& scene, bool isCut) {
      benchmark::RegisterBenchmark(
          ("whole/" + method + "/" + name).c_str(),
          [scene, isCut](benchmark::State& run) { step(run, scene, isCut); })
          ->Unit(benchmark::kMillisecond)
          ->Iterations(kStretch);
    };
    add("pins", hanging(kSide, setting), false);
    add("armed", armed(setting, ""), false);
    add("armed_cut", armed(setting, ""), true);
    add("armed_cut_refined", armed(setting, refined), true);
  }
  return true;
}();

}  // namespace
}  // namespace cloth_sim::bench
