// What a second thread gains, beside what the machine gives: two simulations that have nothing to
// do with each other, on two threads. All three are timed in turns, so that what else the machine
// does meets each of them alike.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "cloth_sim/threads/thread_limit.h"
#include "scenes.h"

namespace cloth_sim::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWarmUp = 3;
constexpr int kStretch = 5;  ///< steps in a turn
constexpr int kTurns = 25;

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

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
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
  std::vector<double> one, two, gain, apart;
  for (auto _ : run) {
    one.push_back(secondsFor([&] { go(first, 1); }));
    two.push_back(secondsFor([&] { go(first, 2); }));
    gain.push_back(one.back() / two.back());
    const double both = secondsFor([&] {
      std::thread other([&] { go(second, 1); });
      go(first, 1);
      other.join();
    });
    apart.push_back(2.0 * one.back() / both);
  }
  if (first.failed() || second.failed()) run.SkipWithError(first.failure().c_str());
  run.counters["one"] = 1e3 * median(one) / kStretch;
  run.counters["two"] = 1e3 * median(two) / kStretch;
  run.counters["gain"] = median(gain);
  run.counters["gain_apart"] = median(apart);
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
