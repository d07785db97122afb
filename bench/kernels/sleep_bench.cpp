// A step of a cloth that has come to rest: asleep, and as it would be if it never slept.

#include <benchmark/benchmark.h>

#include <map>
#include <string>

#include "cloth_sim/threads/thread_limit.h"
#include "scenes.h"

namespace cloth_sim::bench {
namespace {

constexpr int kSide = 128;        ///< particles
constexpr int kWarmUp = 200;      ///< steps, until iterations find what is left of the motion small
constexpr int kMostSteps = 3000;  ///< to come to rest

/// Returns a hanging cloth with much drag and loose limits of sleep, so that it soon falls asleep.
/// The cost of a step of a sleeping cloth does not depend on them.
Scene settling(const std::string& method) {
  Scene scene = hanging(kSide, method);
  scene.drag = 10.0;
  scene.solver.sleep = SleepSettings{0.05, 0.1};
  return scene;
}

/// A state of the cloth asleep, found once for each method.
const std::string& settled(const std::string& method) {
  static std::map<std::string, std::string> found;
  std::string& bytes = found[method];
  if (!bytes.empty()) return bytes;
  Simulation simulation(settling(method));
  for (int k = 0; k < kMostSteps && !simulation.isAsleep(); ++k) simulation.step();
  return bytes = simulation.save();
}

void step(benchmark::State& run, const std::string& method, bool sleeps) {
  const ThreadLimit limit(1);
  Scene scene = settling(method);
  if (!sleeps) scene.solver.sleep.reset();
  Simulation simulation(scene);
  simulation.load(settled(method));
  for (int k = 0; k < kWarmUp; ++k) simulation.step();
  if (simulation.isAsleep() != sleeps) return run.SkipWithError("it did not come to rest");
  for (auto _ : run) simulation.step();
}

const bool kRegistered = [] {
  for (const char* method : {"xpbd", "projective"}) {
    for (const bool sleeps : {true, false}) {
      const std::string name = std::string("sleep/") + method + (sleeps ? "/asleep" : "/awake");
      benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& run) {
        step(run, method, sleeps);
      })->Unit(benchmark::kMicrosecond);
    }
  }
  return true;
}();

}  // namespace
}  // namespace cloth_sim::bench
