// The floor: how fast a sweep over springs can be on this machine when it does nothing else. One
// sweep over a grid whose structure is known, one over springs in any order, coloured. Both correct
// positions of particles of equal mass by half of what a spring is too long, in single precision
// and in the double precision that methods have.

#include <benchmark/benchmark.h>

#include <cmath>

#include "cloth_sim/solver/vector_clones.h"
#include "packed.h"

namespace cloth_sim::bench {
namespace {

template <typename Real>
struct Points {
  std::vector<Real> x, y, z;
};

template <typename Real>
Points<Real> slightlyWavy(int n) {
  Points<Real> p;
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const double u = static_cast<double>(column) / (n - 1);
      const double v = static_cast<double>(row) / (n - 1);
      p.x.push_back(static_cast<Real>(1.01 * u));
      p.y.push_back(static_cast<Real>(0.01 * std::sin(20.0 * u) * std::cos(15.0 * v)));
      p.z.push_back(static_cast<Real>(1.02 * v));
    }
  }
  return p;
}

/// `count` springs from particle `first` on, whose ends are `stride` apart.
template <typename Real>
struct Run {
  std::size_t first, count, stride;
  Real rest;
};

template <typename Real>
[[gnu::always_inline]] inline void correct(const Run<Real>& run, Points<Real>& p) {
  Real* const xa = p.x.data() + run.first;
  Real* const ya = p.y.data() + run.first;
  Real* const za = p.z.data() + run.first;
  Real* const xb = xa + run.stride;
  Real* const yb = ya + run.stride;
  Real* const zb = za + run.stride;
  const Real rest = run.rest;
#pragma GCC ivdep
  for (std::size_t k = 0; k < run.count; ++k) {
    const Real dx = xb[k] - xa[k];
    const Real dy = yb[k] - ya[k];
    const Real dz = zb[k] - za[k];
    const Real s = Real(0.5) * (Real(1) - rest / std::sqrt(dx * dx + dy * dy + dz * dz));
    xa[k] += s * dx;
    ya[k] += s * dy;
    za[k] += s * dz;
    xb[k] -= s * dx;
    yb[k] -= s * dy;
    zb[k] -= s * dz;
  }
}

CLOTH_SIM_VECTOR_CLONES
void correctRun(const Run<float>& run, Points<float>& p) { correct(run, p); }

CLOTH_SIM_VECTOR_CLONES
void correctRun(const Run<double>& run, Points<double>& p) { correct(run, p); }

/// Springs between rows: those between one row and another share no particle, so a row is a run.
/// (Springs within a row would need particles in another order to be runs: the same work.)
template <typename Real>
void structuredSweep(benchmark::State& run) {
  const auto n = static_cast<std::size_t>(run.range(0));
  Points<Real> p = slightlyWavy<Real>(static_cast<int>(n));
  const Real rest = Real(1) / static_cast<Real>(n - 1);
  const Real diagonal = std::sqrt(Real(2)) * rest;
  std::size_t springs = 0;
  for (auto _ : run) {
    springs = 0;
    for (std::size_t row = 0; row + 2 < n; ++row) {
      const std::size_t first = row * n;
      for (const Run<Real>& one : {Run<Real>{first, n, n, rest},
                                   {first, n - 1, n + 1, diagonal},
                                   {first + 1, n - 1, n - 1, diagonal},
                                   {first, n, 2 * n, 2 * rest}}) {
        correctRun(one, p);
        springs += one.count;
      }
    }
    benchmark::ClobberMemory();
  }
  tellPerSpring(static_cast<double>(springs), run);
}
BENCHMARK_TEMPLATE(structuredSweep, float)
    ->Name("floor/structured/float")
    ->RangeMultiplier(2)
    ->Range(32, 1024);
BENCHMARK_TEMPLATE(structuredSweep, double)
    ->Name("floor/structured/double")
    ->RangeMultiplier(2)
    ->Range(32, 1024);

/// Coordinates of a particle side by side: one cache line has four or two of them.
template <typename Real>
struct alignas(4 * sizeof(Real)) Point {
  Real x, y, z, unused;
};

/// Springs of one colour: none share a particle.
template <typename Real>
struct Colour {
  std::size_t count;
  const std::int32_t* a;
  const std::int32_t* b;
  const Real* rest;
};

/// As many as a vector of 32 bytes holds are read, corrected and written at once.
template <typename Real>
[[gnu::always_inline]] inline void correct(const Colour<Real>& springs, Point<Real>* points) {
  constexpr std::size_t kLanes = 32 / sizeof(Real);
  for (std::size_t k = 0; k + kLanes <= springs.count; k += kLanes) {
    Real dx[kLanes], dy[kLanes], dz[kLanes], s[kLanes];
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Point<Real>& p = points[springs.a[k + lane]];
      const Point<Real>& q = points[springs.b[k + lane]];
      dx[lane] = q.x - p.x;
      dy[lane] = q.y - p.y;
      dz[lane] = q.z - p.z;
    }
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Real square = dx[lane] * dx[lane] + dy[lane] * dy[lane] + dz[lane] * dz[lane];
      s[lane] = Real(0.5) * (Real(1) - springs.rest[k + lane] / std::sqrt(square));
    }
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      Point<Real>& p = points[springs.a[k + lane]];
      Point<Real>& q = points[springs.b[k + lane]];
      p.x += s[lane] * dx[lane];
      p.y += s[lane] * dy[lane];
      p.z += s[lane] * dz[lane];
      q.x -= s[lane] * dx[lane];
      q.y -= s[lane] * dy[lane];
      q.z -= s[lane] * dz[lane];
    }
  }
}

CLOTH_SIM_VECTOR_CLONES
void correctColour(const Colour<float>& springs, Point<float>* points) { correct(springs, points); }

CLOTH_SIM_VECTOR_CLONES
void correctColour(const Colour<double>& springs, Point<double>* points) {
  correct(springs, points);
}

/// The springs of a hanging cloth by their colours, as if nothing were known of the mesh.
template <typename Real>
void anySweep(benchmark::State& run) {
  const auto n = static_cast<int>(run.range(0));
  const Packed packed(n, Order::kAny);
  const SpringSchedule& schedule = packed.schedule;
  const Points<Real> wavy = slightlyWavy<Real>(n);
  std::vector<Point<Real>> points(wavy.x.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    points[static_cast<std::size_t>(packed.particles.slotOf[k])] = {wavy.x[k], wavy.y[k], wavy.z[k],
                                                                    Real(0)};
  }
  std::vector<std::int32_t> a, b;
  std::vector<Real> rest;
  schedule.forEach([&](const SpringSchedule::Element& spring) {
    a.push_back(spring.a);
    b.push_back(spring.b);
    rest.push_back(static_cast<Real>(spring.law.restLength));
  });
  for (auto _ : run) {
    for (const SpringSchedule::Span& span : schedule.spans()) {
      correctColour({static_cast<std::size_t>(span.count), a.data() + span.first,
                     b.data() + span.first, rest.data() + span.first},
                    points.data());
    }
    benchmark::ClobberMemory();
  }
  tellPerSpring(static_cast<double>(rest.size()), run);
}
BENCHMARK_TEMPLATE(anySweep, float)
    ->Name("floor/any_topology/float")
    ->RangeMultiplier(2)
    ->Range(32, 1024);
BENCHMARK_TEMPLATE(anySweep, double)
    ->Name("floor/any_topology/double")
    ->RangeMultiplier(2)
    ->Range(32, 1024);

}  // namespace
}  // namespace cloth_sim::bench
