// The cost of surgery. One core: `taskset -c 0 cloth_bench`.

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <optional>

#include "cloth_sim/mesh/grid.h"
#include "cloth_sim/solver/registry.h"
#include "cloth_sim/surgery/operation.h"
#include "cloth_sim/surgery/tearing.h"

namespace cloth_sim {
namespace {

/// Spacing of the particles [m]: that of 128 x 128 on one metre.
constexpr double kSpacing = 1.0 / 127.0;
constexpr double kStep = 1.0 / 60.0;  ///< [s]

TearingSettings armed() {
  TearingSettings settings;
  settings.enabled = true;
  settings.ratio = {10.0, 10.0, 10.0};
  return settings;
}

/// A hanging, slightly wavy cloth of n x n particles, with a solver and a tearing criterion that
/// are updated after its edits.
struct Cloth {
  explicit Cloth(int n) {
    const double size = kSpacing * (n - 1);
    model.cloths[0].grid = Grid{n, n, size, size};
    model.cloths[0].vertices = n * n;
    model.mesh = makeGridMesh(*model.cloths[0].grid);
    model.cloths[0].fabric = fabricPreset("cotton");
    model.springs = SpringNetwork(model.mesh, model.cloths[0].fabric, SpringSelection{});
    lumpMasses(model.cloths[0].fabric.arealDensity, model);
    const auto count = static_cast<std::size_t>(model.particleCount());
    state.x = VertexData<Vec3>(count, Vec3::Zero());
    state.v = VertexData<Vec3>(count, Vec3(0.0, 0.0, -1.0));
    for (VertexId v = 0; v < model.particleCount(); ++v) {
      const Vec2& m = model.mesh.material(v);
      state.x[v] = Vec3(m.x(), 0.01 * std::sin(20.0 * m.x()) * std::cos(15.0 * m.y()), m.y());
    }
    limits.shape.minEdge = 0.05 * kSpacing;
    const SolverInfo& info = findSolver("xpbd");
    solver = info.create(model, completeParameters(info, {}));
    tearing.emplace(armed(), model);
    tearing->plan(model, state, kStep);
  }

  Model model;
  State state;
  SurgeryLimits limits;
  std::unique_ptr<Solver> solver;
  std::optional<Tearing> tearing;
};

/// A stroke along a polyline in the plane of the cloth.
Stroke strokeOver(const std::vector<Vec2>& points) {
  std::vector<Vec3> path;
  for (const Vec2& p : points) path.emplace_back(p.x(), 0.0, p.y());
  return strokeAlong(path, Vec3::UnitY(), 1.0);
}

std::vector<Vec2> circle(const Vec2& centre, double radius, int corners) {
  std::vector<Vec2> points;
  for (int k = 0; k <= corners; ++k) {
    const double angle = 2.0 * M_PI * (k % corners) / corners;
    points.emplace_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return points;
}

/// Performs a cut, from the stroke until the solver and the tearing criterion are ready for the
/// next step. \return the number of failed springs.
std::size_t cutAlong(const Stroke& stroke, int generations, Cloth& cloth) {
  CutPlan plan;
  plan.paths = findPaths(stroke, cloth.model.mesh, cloth.state.x);
  if (generations > 0) plan.refine = Refinement{kSpacing, generations, 0.0};
  const SurgeryResult result = cut(plan, cloth.limits, {}, cloth.model, cloth.state);
  cloth.solver->onModelChanged(cloth.model, result.changes);
  cloth.tearing->applyChanges(cloth.model, result.changes);
  benchmark::DoNotOptimize(cloth.tearing->plan(cloth.model, cloth.state, kStep).paths.size());
  benchmark::DoNotOptimize(connectedComponents(cloth.model.mesh).count);
  return result.events.size();
}

void runStroke(benchmark::State& run, int n, const Stroke& stroke, int generations) {
  std::optional<Cloth> cloth;  // outside of the loop: what it frees is not timed
  std::size_t severed = 0;
  for (auto _ : run) {
    run.PauseTiming();
    cloth.emplace(n);  // a copy would have no room to grow, unlike one in a run
    // A small one first: after it, arrays have room to grow, as in a run.
    cutAlong(strokeOver({{-kSpacing, kSpacing}, {kSpacing, -kSpacing}}), 0, *cloth);
    run.ResumeTiming();
    severed = cutAlong(stroke, generations, *cloth);
  }
  run.counters["severed"] = static_cast<double>(severed);
}

/// Across the whole cloth, at a slant: arguments are n and the generations of refinement.
void fullWidthStroke(benchmark::State& run) {
  const auto n = static_cast<int>(run.range(0));
  const double size = kSpacing * (n - 1);
  const Stroke stroke = strokeOver({{-0.1 * size, 0.43 * size}, {1.1 * size, 0.58 * size}});
  runStroke(run, n, stroke, static_cast<int>(run.range(1)));
}
BENCHMARK(fullWidthStroke)
    ->Name("surgery/full_width_stroke")
    ->ArgNames({"side", "generations"})
    ->ArgsProduct({{128}, {0, 1, 2, 3}})
    ->Unit(benchmark::kMillisecond);

/// A circle of a radius of a tenth of a metre on cloths of different sizes.
void sameStroke(benchmark::State& run) {
  const auto n = static_cast<int>(run.range(0));
  const double size = kSpacing * (n - 1);
  const Stroke stroke = strokeOver(circle(Vec2(0.5 * size, 0.5 * size), 0.1, 64));
  runStroke(run, n, stroke, static_cast<int>(run.range(1)));
}
BENCHMARK(sameStroke)
    ->Name("surgery/same_stroke")
    ->ArgNames({"side", "generations"})
    ->ArgsProduct({{64, 128, 256}, {0, 2}})
    ->Unit(benchmark::kMillisecond);

/// The step after a slit of a centimetre: `projective` brings its factorisation along.
void stepAfterSlit(benchmark::State& run) {
  const auto n = static_cast<int>(run.range(0));
  const double middle = 0.5 * kSpacing * (n - 1);
  const Stroke stroke = strokeOver({{middle, middle}, {middle + 0.012, middle + 0.003}});
  const SolverInfo& info = findSolver("projective");
  const Controls controls;
  Contacts none;
  std::optional<Cloth> cloth;
  for (auto _ : run) {
    run.PauseTiming();
    cloth.emplace(n);
    cloth->solver =
        info.create(cloth->model, completeParameters(info, {{"substeps", 1}, {"iterations", 1}}));
    cloth->solver->step(cloth->model, cloth->state, controls, none, {kStep});
    cutAlong(stroke, 0, *cloth);
    run.ResumeTiming();
    cloth->solver->step(cloth->model, cloth->state, controls, none, {kStep});
  }
}
BENCHMARK(stepAfterSlit)
    ->Name("surgery/projective_after_slit")
    ->ArgName("side")
    ->Arg(64)
    ->Arg(128)
    ->Arg(256)
    ->Iterations(3)
    ->Unit(benchmark::kMillisecond);

void findingPaths(benchmark::State& run) {
  const auto n = static_cast<int>(run.range(0));
  const double size = kSpacing * (n - 1);
  const Cloth cloth(n);
  const Stroke stroke = strokeOver(circle(Vec2(0.5 * size, 0.5 * size), 0.1, 64));
  for (auto _ : run) {
    benchmark::DoNotOptimize(findPaths(stroke, cloth.model.mesh, cloth.state.x));
  }
}
BENCHMARK(findingPaths)
    ->Name("surgery/find_paths")
    ->Arg(64)
    ->Arg(128)
    ->Arg(256)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace cloth_sim
