// What a step and its surroundings are made of, each alone, at 128 x 128 and other sizes.

#include <benchmark/benchmark.h>

#include "cloth_sim/sim/snapshot.h"
#include "scenes.h"
#include "solver/spring_forces.h"
#include "solver/updatable_factor.h"

namespace cloth_sim::bench {
namespace {

/// Particles and springs of a hanging cloth, packed.
struct Packed {
  explicit Packed(int n) : simulation(hanging(n, "xpbd")) {
    const Model& model = simulation.model();
    particles.layOut(model);
    particles.resize();
    particles.load(simulation.state());
    particles.loadMasses(model, {});
    schedule.build(model, particles.slotOf);
    force.resize(static_cast<std::size_t>(particles.slots));
  }

  Simulation simulation;
  PackedParticles particles;
  SpringSchedule schedule;
  PackedVectors force;
};

void springForces(benchmark::State& run) {
  Packed packed(static_cast<int>(run.range(0)));
  for (auto _ : run) {
    addSpringForces(packed.schedule, packed.particles.x, packed.particles.v, packed.force);
    benchmark::ClobberMemory();
  }
  tellPerSpring(packed.schedule.size(), run);
}
BENCHMARK(springForces)->Name("kernel/spring_forces")->RangeMultiplier(2)->Range(32, 1024);

UpdatableFactor::Matrix globalMatrix(const Packed& packed) {
  std::vector<Eigen::Triplet<double>> entries;
  constexpr double kFrame = 1.0 / 60.0;
  for (Eigen::Index k = 0; k < packed.particles.slots; ++k) {
    entries.emplace_back(k, k, packed.particles.mass[static_cast<std::size_t>(k)]);
  }
  for (std::size_t p = 0; p < packed.schedule.endA.size(); ++p) {
    const double w = kFrame * kFrame * packed.schedule.stiffness[p];
    const std::int32_t a = packed.schedule.endA[p];
    const std::int32_t b = packed.schedule.endB[p];
    entries.emplace_back(a, a, w);
    entries.emplace_back(b, b, w);
    entries.emplace_back(std::max(a, b), std::min(a, b), -w);
  }
  UpdatableFactor::Matrix matrix(packed.particles.slots, packed.particles.slots);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

void factorise(benchmark::State& run) {
  const UpdatableFactor::Matrix matrix = globalMatrix(Packed(static_cast<int>(run.range(0))));
  UpdatableFactor factor;
  for (auto _ : run) factor.compute(matrix);
}
BENCHMARK(factorise)
    ->Name("kernel/factorise")
    ->RangeMultiplier(2)
    ->Range(32, 256)
    ->Unit(benchmark::kMillisecond);

void solve(benchmark::State& run) {
  const Packed packed(static_cast<int>(run.range(0)));
  UpdatableFactor factor;
  factor.compute(globalMatrix(packed));
  PackedVectors x;
  for (auto _ : run) factor.solve(packed.particles.x, x);
  tellPerSpring(packed.schedule.size(), run);
}
BENCHMARK(solve)
    ->Name("kernel/triangular_solves")
    ->RangeMultiplier(2)
    ->Range(32, 256)
    ->Unit(benchmark::kMillisecond);

void detectContacts(benchmark::State& run) {
  Warm warm(overSphere(static_cast<int>(run.range(0)), "xpbd"), 20);
  const Simulation& simulation = warm.simulation();
  Contacts contacts;
  for (auto _ : run) {
    contacts.clear();
    simulation.colliders().detect(simulation.state(), 1.0 / 60.0, 1e-3, contacts);
  }
  std::size_t near = 0;
  for (const ContactCandidates& c : contacts.candidates) near += c.vertices.size();
  run.counters["candidates"] = static_cast<double>(near);
}
BENCHMARK(detectContacts)->Name("part/detect_contacts")->Arg(64)->Arg(128)->Arg(256);

void projectContacts(benchmark::State& run) {
  Warm warm(overSphere(static_cast<int>(run.range(0)), "xpbd"), 20);
  const Simulation& simulation = warm.simulation();
  Contacts contacts;
  contacts.clear();
  simulation.colliders().detect(simulation.state(), 1.0 / 60.0, 1e-3, contacts);
  PackedParticles particles;
  particles.layOut(simulation.model());
  particles.resize();
  particles.load(simulation.state());
  particles.loadMasses(simulation.model(), {});
  particles.start = particles.x;
  for (auto _ : run) contacts.project(particles.view(), simulation.time(), 1e-3);
}
BENCHMARK(projectContacts)->Name("part/project_contacts")->Arg(64)->Arg(128)->Arg(256);

void tearLaw(benchmark::State& run) {
  const Simulation simulation(hanging(static_cast<int>(run.range(0)), "xpbd"));
  TearingSettings settings;
  settings.enabled = true;
  Tearing tearing(settings, simulation.model());
  for (auto _ : run) {
    benchmark::DoNotOptimize(tearing.plan(simulation.model(), simulation.state(), 1.0 / 60.0));
  }
}
BENCHMARK(tearLaw)->Name("part/tear_law")->Arg(64)->Arg(128)->Arg(256);

void snapshot(benchmark::State& run) {
  Warm warm(hanging(static_cast<int>(run.range(0)), "xpbd"), 2);
  for (auto _ : run) {
    benchmark::DoNotOptimize(warm.simulation().snapshot());
    run.PauseTiming();
    warm.simulation().step();  // or it is the one that was made before
    run.ResumeTiming();
  }
}
BENCHMARK(snapshot)->Name("part/snapshot")->Arg(64)->Arg(128)->Arg(256)->Iterations(50);

void startUp(benchmark::State& run, const std::string& method) {
  const Scene scene = hanging(static_cast<int>(run.range(0)), method);
  for (auto _ : run) {
    Simulation simulation(scene);
    simulation.step();
  }
}
BENCHMARK_CAPTURE(startUp, xpbd, "xpbd")
    ->Name("part/start_up/xpbd")
    ->RangeMultiplier(2)
    ->Range(32, 1024)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(startUp, projective, "projective")
    ->Name("part/start_up/projective")
    ->RangeMultiplier(2)
    ->Range(32, 256)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace cloth_sim::bench
