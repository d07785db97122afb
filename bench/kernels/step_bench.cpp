// A whole step, by every method, over the size of the cloth; from the same state each time. What
// has a limit of stability divides the step until it is below.

#include <benchmark/benchmark.h>

#include <stdexcept>

#include "cloth_sim/threads/thread_limit.h"
#include "scenes.h"

namespace cloth_sim::bench {
namespace {

constexpr int kWarmUp = 3;
/// Steps from one return to the state after the warm-up to the next.
constexpr int kStretch = 5;

void step(benchmark::State& run, const std::string& method, int threads) {
  const ThreadLimit limit(threads);
  Scene scene = hanging(static_cast<int>(run.range(0)), method);
  scene.solver.guard = StepGuard::kSubdivide;
  Warm warm(scene, kWarmUp);
  timeSteps(warm, kStretch, run);
  const Simulation& simulation = warm.simulation();
  const double springs = simulation.model().springs.count();
  tellPerSpring(springs, run);
  run.counters["substeps"] = simulation.lastReport().substeps;
  run.counters["iterations"] = simulation.lastReport().iterations;
}

/// One benchmark a method, as the registry has them, with the defaults of its parameters.
const bool kRegistered = [] {
  for (const SolverInfo& info : solverRegistry()) {
    for (const int threads : {1, 2}) {
      const std::string name = "step/" + info.name + "/threads:" + std::to_string(threads);
      benchmark::RegisterBenchmark(
          name.c_str(),
          [method = info.name, threads](benchmark::State& run) {
            try {
              step(run, method, threads);
            } catch (const std::invalid_argument& error) {  // at no step without damping
              run.SkipWithError(error.what());
            }
          })
          ->RangeMultiplier(2)
          ->Range(32, 1024)
          ->ArgName("side")
          ->MeasureProcessCPUTime()
          ->UseRealTime()
          ->Unit(benchmark::kMillisecond);
    }
  }
  return true;
}();

}  // namespace
}  // namespace cloth_sim::bench
