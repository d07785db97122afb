// The gain of a second thread, beside the most that the machine can give: two independent
// simulations on two threads. The three are timed in turns, so that other load on the machine meets
// each of them alike.

#include <benchmark/benchmark.h>

#include <chrono>
#include <thread>

#include "cloth_sim/threads/thread_limit.h"
#include "scenes.h"
#include "turns.h"

namespace cloth_sim::bench {
namespace {

constexpr int kStretch = 20;  ///< steps in a turn
constexpr int kWarmUp = 3;    ///< steps between two looks at the clock while warming up
constexpr int kTurns = 15;
/// Warm-up before a turn, until threads have settled on their cores: a thread that wakes may begin
/// on the core of the one that woke it, and be moved milliseconds later.
constexpr std::chrono::milliseconds kAhead{50};

/// Takes `steps` steps on `threads` threads.
void go(Simulation& simulation, int threads, int steps) {
  const ThreadLimit limit(threads);
  for (int k = 0; k < steps; ++k) simulation.step();
}

Scene sceneOf(int n, const std::string& method) {
  Scene scene = hanging(n, method);
  // The settings of the rows beside a peer.
  if (method == "projective") scene.solver.parameters = {{"substeps", 1.0}, {"iterations", 1.0}};
  return scene;
}

void threads(benchmark::State& run, const std::string& method) {
  const Scene scene = sceneOf(static_cast<int>(run.range(0)), method);
  Simulation first(scene);
  Simulation second(scene);
  const auto goApart = [&](int steps) {
    std::thread other([&] { go(second, 1, steps); });
    go(first, 1, steps);
    other.join();
  };
  Turns turns;
  const auto takeTurn = [&](const char* name, const auto& goOn) {
    const auto end = std::chrono::steady_clock::now() + kAhead;
    do goOn(kWarmUp);
    while (std::chrono::steady_clock::now() < end);
    turns.time(name, [&] { goOn(kStretch); });
  };
  for (auto _ : run) {
    takeTurn("one", [&](int steps) { go(first, 1, steps); });
    takeTurn("two", [&](int steps) { go(first, 2, steps); });
    takeTurn("both", goApart);
  }
  if (first.failed() || second.failed()) run.SkipWithError(first.failure().c_str());
  run.counters["one"] = 1e3 * turns.median("one") / kStretch;
  run.counters["two"] = 1e3 * turns.median("two") / kStretch;
  run.counters["gain"] = turns.medianOver("one", "two");
  run.counters["gain_apart"] = 2.0 * turns.medianOver("one", "both");
}

const bool kRegistered = [] {
  for (const char* method : {"line_xpbd", "xpbd", "projective"}) {
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
