// The kernels: one pass over springs and bending elements, and the global solve.

#include <benchmark/benchmark.h>

#include "constraints/bend_projection.h"
#include "constraints/spring_forces.h"
#include "constraints/spring_hessian.h"
#include "constraints/spring_projection.h"
#include "linalg/bend_matrix.h"
#include "linalg/updatable_factor.h"
#include "packed.h"

namespace cloth_sim::bench {
namespace {

void springForces(benchmark::State& run, Order order) {
  Packed packed(static_cast<int>(run.range(0)), order);
  for (auto _ : run) {
    addSpringForces(packed.schedule, packed.particles.x, packed.particles.v, packed.force);
    benchmark::ClobberMemory();
  }
  tellPerSpring(packed.schedule.size(), run);
}
BENCHMARK_CAPTURE(springForces, grid, Order::kGrid)
    ->Name("kernel/spring_forces")
    ->RangeMultiplier(2)
    ->Range(32, 1024);
BENCHMARK_CAPTURE(springForces, any, Order::kAny)->Name("kernel/spring_forces_any")->Arg(128);

void springProjection(benchmark::State& run, Order order) {
  Packed packed(static_cast<int>(run.range(0)), order);
  SpringProjection projection;
  projection.setMasses(packed.schedule, packed.particles.inverseMass);
  projection.setStep(packed.schedule, packed.particles.inverseMass, kSubstep);
  for (auto _ : run) {
    projection.project(packed.schedule, packed.particles);
    benchmark::ClobberMemory();
  }
  tellPerSpring(packed.schedule.size(), run);
}
BENCHMARK_CAPTURE(springProjection, grid, Order::kGrid)
    ->Name("kernel/spring_corrections")
    ->RangeMultiplier(2)
    ->Range(32, 1024);
BENCHMARK_CAPTURE(springProjection, any, Order::kAny)
    ->Name("kernel/spring_corrections_any")
    ->RangeMultiplier(2)
    ->Range(32, 1024);

void springProduct(benchmark::State& run) {
  Packed packed(static_cast<int>(run.range(0)), Order::kGrid);
  SpringHessian hessian;
  hessian.linearise(packed.schedule, packed.particles.x, kFrame * kFrame, kFrame);
  VectorArray product = packed.particles.x;
  for (auto _ : run) {
    hessian.addProduct(packed.schedule, packed.particles.x, product);
    benchmark::ClobberMemory();
  }
  tellPerSpring(packed.schedule.size(), run);
}
BENCHMARK(springProduct)->Name("kernel/spring_product")->RangeMultiplier(2)->Range(32, 1024);

/// Bending elements of a cloth that resists bending, over its springs.
void bendProjection(benchmark::State& run) {
  Packed packed(static_cast<int>(run.range(0)), Order::kGrid, "plate");
  BendProjection projection;
  projection.build(packed.simulation.model().bending, packed.particles);
  projection.setStep({kSubstep}, packed.particles.inverseMass);
  for (auto _ : run) {
    projection.project(packed.particles, packed.particles.inverseMass,
                       [](std::size_t, const Vec3&) {});
    benchmark::ClobberMemory();
  }
  tellPerSpring(packed.schedule.size(), run);
}
BENCHMARK(bendProjection)->Name("kernel/bend_corrections")->Arg(64)->Arg(128)->Arg(256);

void bendForces(benchmark::State& run) {
  Packed packed(static_cast<int>(run.range(0)), Order::kGrid, "plate");
  BendMatrix matrix;
  matrix.build(packed.simulation.model(), packed.particles);
  for (auto _ : run) {
    matrix.addForces(packed.particles.x, packed.particles.v, packed.force);
    benchmark::ClobberMemory();
  }
  tellPerSpring(packed.schedule.size(), run);
}
BENCHMARK(bendForces)->Name("kernel/bend_forces")->Arg(64)->Arg(128)->Arg(256);

UpdatableFactor::Matrix globalMatrix(const Packed& packed) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index k = 0; k < packed.particles.slots; ++k) {
    entries.emplace_back(k, k, packed.particles.mass[static_cast<std::size_t>(k)]);
  }
  packed.schedule.forEach([&](const SpringSchedule::Element& spring) {
    const double w = kFrame * kFrame * spring.parameters.stiffness;
    entries.emplace_back(spring.a, spring.a, w);
    entries.emplace_back(spring.b, spring.b, w);
    entries.emplace_back(std::max(spring.a, spring.b), std::min(spring.a, spring.b), -w);
  });
  UpdatableFactor::Matrix matrix(packed.particles.slots, packed.particles.slots);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

void factorise(benchmark::State& run) {
  const UpdatableFactor::Matrix matrix =
      globalMatrix(Packed(static_cast<int>(run.range(0)), Order::kGrid));
  UpdatableFactor factor;
  for (auto _ : run) benchmark::DoNotOptimize(factor.compute(matrix));
}
BENCHMARK(factorise)
    ->Name("kernel/factorise")
    ->RangeMultiplier(2)
    ->Range(32, 256)
    ->Unit(benchmark::kMillisecond);

void solve(benchmark::State& run) {
  const Packed packed(static_cast<int>(run.range(0)), Order::kGrid);
  UpdatableFactor factor;
  if (!factor.compute(globalMatrix(packed))) return run.SkipWithError("not positive definite");
  VectorArray x;
  factor.solve(packed.particles.x, x);  // copies the factor
  for (auto _ : run) factor.solve(packed.particles.x, x);
  tellPerSpring(packed.schedule.size(), run);
}
BENCHMARK(solve)
    ->Name("kernel/triangular_solves")
    ->RangeMultiplier(2)
    ->Range(32, 256)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace cloth_sim::bench
