// What a second thread gains, beside what the machine gives: two simulations that have nothing to
// do with each other, on two threads. All three are timed in turns, so that what else the machine
// does meets each of them alike.

#include <benchmark/benchmark.h>

#include <chrono>
#include <thread>

#include "cloth_sim/threads/thread_limit.h"
#include "scenes.h"

namespace cloth_sim::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWarmUp = 3;
constexpr int kStretch = 5;  ///< steps in a turn
constexpr int kTurns = 12;

/// Takes kStretch steps on so many threads.
void go(Simulation& simulation, int threads) {
  const ThreadLimit limit(threads);
  for (int k = 0; k < kStretch; ++k) simulation.step();
}

template <typename Work>
double secondsFor(const Work& work) {
  const Clock::time_point start = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Scene sceneOf(int n, const std::string& method) {
  Scene scene = hanging(n, method);
  // What is as accurate as the rows beside a peer.
  if (method == "projective") scene.solver.parameters = {{"substeps", 1.0}, {"iterations", 1.0}};
  return scene;
}

void threads(benchmark::State& run, const std::string& method) {
  const Scene scene = sceneOf(static_cast<int>(run.range(0)), method);
  Simulation first(scene);
  Simulation second(scene);
  for (int k = 0; k < kWarmUp; ++k) {
    go(first, 2);
    go(second, 1);
  }
  double one = 0.0;
  double two = 0.0;
  double apart = 0.0;
  for (auto _ : run) {
    one += secondsFor([&] { go(first, 1); });
    two += secondsFor([&] { go(first, 2); });
    apart += secondsFor([&] {
      std::thread other([&] { go(second, 1); });
      go(first, 1);
      other.join();
    });
  }
  if (first.failed() || second.failed()) run.SkipWithError(first.failure().c_str());
  const double steps = static_cast<double>(run.iterations()) * kStretch;
  run.counters["one"] = 1e3 * one / steps;
  run.counters["two"] = 1e3 * two / steps;
  run.counters["gain"] = one / two;
  run.counters["gain_apart"] = 2.0 * one / apart;
}

const bool registered = [] {
  for (const char* method : {"xpbd", "projective"}) {
    benchmark::RegisterBenchmark((std::string("threads/") + method).c_str(),
                                 [method](benchmark::State& run) { threads(run, method); })
        ->RangeMultiplier(2)
        ->Range(32, 256)
        ->ArgName("side")
        ->Iterations(kTurns)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
}  // namespace cloth_sim::bench
