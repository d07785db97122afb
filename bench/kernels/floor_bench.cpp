// The floor: how fast a sweep over springs can be on this machine when it does nothing else. One
// sweep over a grid whose structure is known, one over springs in any order, coloured. Both correct
// positions of particles of equal mass by half of what a spring is too long.

#include <benchmark/benchmark.h>

#include <cmath>

#include "cloth_sim/solver/spring_schedule.h"
#include "cloth_sim/solver/vector_clones.h"
#include "scenes.h"

namespace cloth_sim::bench {
namespace {

using Floats = std::vector<float>;

struct Points {
  Floats x, y, z;
};

Points slightlyWavy(int n) {
  Points p;
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const auto u = static_cast<float>(column) / static_cast<float>(n - 1);
      const auto v = static_cast<float>(row) / static_cast<float>(n - 1);
      p.x.push_back(1.01F * u);
      p.y.push_back(0.01F * std::sin(20.0F * u) * std::cos(15.0F * v));
      p.z.push_back(1.02F * v);
    }
  }
  return p;
}

/// `count` springs whose ends are `stride` apart, every `every`-th particle from `first` on.
CLOTH_SIM_VECTOR_CLONES
void correctRun(std::size_t count, std::size_t first, std::size_t stride, float rest, float* x,
                float* y, float* z) {
  float* const xa = x + first;
  float* const ya = y + first;
  float* const za = z + first;
  float* const xb = xa + stride;
  float* const yb = ya + stride;
  float* const zb = za + stride;
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const float dx = xb[k] - xa[k];
    const float dy = yb[k] - ya[k];
    const float dz = zb[k] - za[k];
    const float s = 0.5F * (1.0F - rest / std::sqrt(dx * dx + dy * dy + dz * dz));
    xa[k] += s * dx;
    ya[k] += s * dy;
    za[k] += s * dz;
    xb[k] -= s * dx;
    yb[k] -= s * dy;
    zb[k] -= s * dz;
  }
}

/// Springs between rows: those between one row and another share no particle, so a row is a run.
/// (Springs within a row would need particles in another order to be runs: the same work.)
void structuredSweep(benchmark::State& run) {
  const auto n = static_cast<std::size_t>(run.range(0));
  Points p = slightlyWavy(static_cast<int>(n));
  const float rest = 1.0F / static_cast<float>(n - 1);
  const float diagonal = std::sqrt(2.0F) * rest;
  std::size_t springs = 0;
  for (auto _ : run) {
    springs = 0;
    for (std::size_t row = 0; row + 2 < n; ++row) {
      const std::size_t first = row * n;
      const auto pass = [&](std::size_t from, std::size_t count, std::size_t stride, float length) {
        correctRun(count, from, stride, length, p.x.data(), p.y.data(), p.z.data());
        springs += count;
      };
      pass(first, n, n, rest);
      pass(first, n - 1, n + 1, diagonal);
      pass(first + 1, n - 1, n - 1, diagonal);
      pass(first, n, 2 * n, 2.0F * rest);
    }
    benchmark::ClobberMemory();
  }
  tellPerSpring(static_cast<double>(springs), run);
}
BENCHMARK(structuredSweep)->Name("floor/structured")->RangeMultiplier(2)->Range(32, 1024);

/// Coordinates of a particle side by side: one cache line has four of them.
struct alignas(16) Point {
  float x, y, z, unused;
};

constexpr std::size_t kLanes = 8;

/// Springs of one colour: none share a particle, so eight at a time can be read, corrected and
/// written.
CLOTH_SIM_VECTOR_CLONES
void correctColour(std::size_t count, const std::int32_t* a, const std::int32_t* b,
                   const float* rest, Point* points) {
  std::size_t k = 0;
  for (; k + kLanes <= count; k += kLanes) {
    float dx[kLanes], dy[kLanes], dz[kLanes], s[kLanes];
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Point& p = points[a[k + lane]];
      const Point& q = points[b[k + lane]];
      dx[lane] = q.x - p.x;
      dy[lane] = q.y - p.y;
      dz[lane] = q.z - p.z;
    }
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float square = dx[lane] * dx[lane] + dy[lane] * dy[lane] + dz[lane] * dz[lane];
      s[lane] = 0.5F * (1.0F - rest[k + lane] / std::sqrt(square));
    }
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      Point& p = points[a[k + lane]];
      Point& q = points[b[k + lane]];
      p.x += s[lane] * dx[lane];
      p.y += s[lane] * dy[lane];
      p.z += s[lane] * dz[lane];
      q.x -= s[lane] * dx[lane];
      q.y -= s[lane] * dy[lane];
      q.z -= s[lane] * dz[lane];
    }
  }
}

/// The springs of a hanging cloth by their colours, as if nothing were known of the mesh.
void anySweep(benchmark::State& run) {
  const auto n = static_cast<int>(run.range(0));
  const Simulation simulation(hanging(n, "xpbd"));
  std::vector<std::int32_t> slotOf(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  for (std::size_t k = 0; k < slotOf.size(); ++k) slotOf[k] = static_cast<std::int32_t>(k);
  SpringSchedule schedule;
  schedule.build(simulation.model(), slotOf);
  const Points wavy = slightlyWavy(n);
  std::vector<Point> points;
  for (std::size_t k = 0; k < wavy.x.size(); ++k) {
    points.push_back({wavy.x[k], wavy.y[k], wavy.z[k], 0.0F});
  }
  const Floats rest(schedule.restLength.begin(), schedule.restLength.end());
  for (auto _ : run) {
    for (const SpringSchedule::Span& span : schedule.spans()) {
      const auto first = static_cast<std::size_t>(span.first);
      correctColour(static_cast<std::size_t>(span.count), schedule.endA.data() + first,
                    schedule.endB.data() + first, rest.data() + first, points.data());
    }
    benchmark::ClobberMemory();
  }
  tellPerSpring(static_cast<double>(rest.size()), run);
}
BENCHMARK(anySweep)->Name("floor/any_topology")->RangeMultiplier(2)->Range(32, 1024);

}  // namespace
}  // namespace cloth_sim::bench
