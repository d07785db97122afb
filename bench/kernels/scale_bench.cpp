// The cost of a large cloth before its first step: time, and memory by owner.

#include <benchmark/benchmark.h>
#include <malloc.h>
#include <unistd.h>

#include <fstream>
#include <memory>

#include "cloth_sim/scene/build.h"
#include "cloth_sim/solver/registry.h"
#include "scenes.h"

namespace cloth_sim::bench {
namespace {

/// Memory of this process that is in use [bytes].
double resident() {
  malloc_trim(0);
  double total = 0.0;
  double pages = 0.0;
  std::ifstream("/proc/self/statm") >> total >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// The most that was in use since `forgetPeak` [bytes].
double peak() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != "VmHWM:") continue;
    double kilobytes = 0.0;
    status >> kilobytes;
    return 1024.0 * kilobytes;
  }
  return 0.0;
}

void forgetPeak() { std::ofstream("/proc/self/clear_refs") << 5; }

/// Bytes per particle, as counters of their own.
class Account {
 public:
  explicit Account(benchmark::State& run)
      : run_(run),
        particles_(static_cast<double>(run.range(0)) * static_cast<double>(run.range(0))),
        last_(resident()) {}

  /// Counts the memory added since the last call under `thing`.
  void book(const std::string& thing) {
    const double now = resident();
    run_.counters[thing] = (now - last_) / particles_;
    last_ = now;
  }

 private:
  benchmark::State& run_;
  double particles_;
  double last_;
};

/// Everything a simulation does before its first step; and the memory when it is done, at its peak,
/// and after that step.
void load(benchmark::State& run, const std::string& method) {
  const auto n = static_cast<int>(run.range(0));
  const double particles = static_cast<double>(n) * n;
  const double before = resident();
  forgetPeak();
  for (auto _ : run) {
    Simulation simulation(hanging(n, method));
    run.PauseTiming();
    run.counters["peak"] = (peak() - before) / particles;
    run.counters["loaded"] = (resident() - before) / particles;
    simulation.step();
    run.counters["stepped"] = (resident() - before) / particles;
    run.ResumeTiming();
  }
}

/// The same in parts: what each of them takes.
void parts(benchmark::State& run, const std::string& method) {
  for (auto _ : run) {
    Account account(run);
    const Scene scene = hanging(static_cast<int>(run.range(0)), method);
    account.book("scene");
    const ClothSpec& cloth = scene.cloths.front();
    const TriangleMesh mesh = makeGridMesh({cloth.columns, cloth.rows, cloth.width, cloth.height});
    account.book("mesh");
    const SpringNetwork springs(mesh, cloth.fabric, cloth.springs);
    account.book("springs");
    const Model model = buildModel(scene.cloths);
    account.book("model");  // with a mesh and springs of its own
    const State state = initialState(scene.cloths, model, scene.seed);
    account.book("state");
    const SolverInfo& info = findSolver(method);
    const auto solver = info.create(model, completeParameters(info, scene.solver.parameters));
    account.book("solver");
  }
}

const bool kRegistered = [] {
  const auto add = [](const std::string& name, const auto& measured, const std::string& method) {
    benchmark::RegisterBenchmark(
        (name + method).c_str(),
        [measured, method](benchmark::State& run) { measured(run, method); })
        ->ArgName("side")
        ->Arg(256)
        ->Arg(1024)
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  };
  for (const char* method : {"xpbd", "projective"}) {
    add("scale/load/", load, method);
    add("scale/parts/", parts, method);
  }
  return true;
}();

}  // namespace
}  // namespace cloth_sim::bench
