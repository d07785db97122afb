// Steps of a whole scene in turns: hanging; held by clamps, over a ground, with tearing armed; and
// that after cuts.

#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/threads/thread_limit.h"
#include "scenes.h"
#include "turns.h"

namespace cloth_sim::bench {
namespace {

constexpr int kSide = 128;
/// Steps until the clamps have closed and what a cut set off is over.
constexpr int kWarmUp = 40;
/// Steps of a turn, after which it goes back to the state after the warm-up. Some of them are
/// divided where a spring is near failing.
constexpr int kStretch = 20;
constexpr int kTurns = 5;

/// Returns the scene of `hanging` with clamps instead of pins, a ground and a ball in reach, and
/// tearing enabled.
/// \param method  name and parameters of the method, as in a scene file.
Scene armed(const std::string& method) {
  const auto clamp = [](const std::string& name, const std::string& column, const std::string& x) {
    return "  " + name + ":\n    patch: {particle: [" + column +
           ", 127], radius: 1}\n    pose: {position: [" + x +
           ", 0, 1.5], rpy: [1.5707963267948966, 0, 0]}\n    gap_open: 0.021\n";
  };
  return parseScene(
      "cloth:\n  particles: [128, 128]\n  fabric: {preset: cotton, areal_density: 0.2}\n"
      "  bending: springs\n"
      "  pose: {position: [0, 0, 1], rpy: [1.5707963267948966, 0, 0]}\n"
      "clamps:\n" +
          clamp("left", "0", "-0.5") + clamp("right", "127", "0.5") +
          "phases: [{name: all, clamps: {all: {grasp: true}}}]\n"
          "obstacles:\n  ground: {type: plane}\n"
          "  ball: {type: sphere, radius: 0.2, position: [0, 0.21, 0.5]}\n"
          "tearing: {ratio: 10}\ndrag: 0.5\nsolver: {sleep: false, method: " +
          method + "}\n",
      "armed");
}

/// A scene that has its turns.
struct Entry {
  Entry(std::string called, const Scene& scene, bool isCut) : name(std::move(called)) {
    auto begun = std::make_unique<Simulation>(scene);
    begun->step();
    if (isCut) cutSlits(*begun);
    warm = std::make_unique<Warm>(std::move(begun), kWarmUp);
  }
  void takeTurn(Turns& turns) {
    warm->goBack();
    Simulation& simulation = warm->simulation();
    turns.time(name, [&] {
      for (int k = 0; k < kStretch; ++k) simulation.step();
    });
  }

  std::string name;
  std::unique_ptr<Warm> warm;
};

void whole(benchmark::State& run, const std::string& method) {
  const ThreadLimit limit(1);
  std::vector<Entry> entries;
  entries.emplace_back("pins", hanging(kSide, method), false);
  entries.emplace_back("armed", armed(method), false);
  entries.emplace_back("cut", armed(method), true);
  entries.emplace_back("refined", refinedWhenCut(armed(method)), true);
  Turns turns;
  for (auto _ : run) {
    for (Entry& entry : entries) entry.takeTurn(turns);
  }
  for (const Entry& entry : entries) {
    const Simulation& simulation = entry.warm->simulation();
    if (simulation.failed()) run.SkipWithError(simulation.failure().c_str());
    run.counters[entry.name] = 1e3 * turns.median(entry.name) / kStretch;
    run.counters[entry.name + "_over_pins"] = turns.medianOver(entry.name, "pins");
    run.counters[entry.name + "_over_armed"] = turns.medianOver(entry.name, "armed");
    run.counters[entry.name + "_particles"] = simulation.model().particleCount();
    run.counters[entry.name + "_springs"] = simulation.model().springs.count();
  }
}

const bool kRegistered = [] {
  const auto add = [](const char* name, const std::string& method) {
    benchmark::RegisterBenchmark(name, [method](benchmark::State& run) { whole(run, method); })
        ->Iterations(kTurns)
        ->Unit(benchmark::kMillisecond);
  };
  add("whole/xpbd", "xpbd");
  add("whole/projective", "projective, substeps: 1, iterations: 1");
  return true;
}();

}  // namespace
}  // namespace cloth_sim::bench
