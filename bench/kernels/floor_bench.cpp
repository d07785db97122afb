// The floor: how fast a sweep over springs can be on this machine when it does nothing else, beside
// the sweep that `xpbd` has, in turns. One sweep over a grid whose structure is known, one over
// springs in any order, coloured. Both correct positions of particles of equal mass by half of what
// a spring is too long, in single precision and in the double precision that methods have.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>

#include "constraints/spring_projection.h"
#include "packed.h"
#include "support/cache_aligned.h"
#include "support/vector_clones.h"
#include "turns.h"

namespace cloth_sim::bench {
namespace {

template <typename Real>
struct Points {
  CacheAlignedVector<Real> x, y, z;
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
  CLOTH_SIM_NO_ALIAS_LOOP
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
class StructuredSweep {
 public:
  explicit StructuredSweep(const Packed& packed)
      : n_(static_cast<std::size_t>(packed.simulation.model().cloths[0].grid->columns)),
        points_(slightlyWavy<Real>(static_cast<int>(n_))) {}

  std::size_t springs() const { return (n_ - 2) * (4 * n_ - 2); }
  void go() {
    const Real rest = Real(1) / static_cast<Real>(n_ - 1);
    const Real diagonal = std::sqrt(Real(2)) * rest;
    for (std::size_t row = 0; row + 2 < n_; ++row) {
      const std::size_t first = row * n_;
      correctRun(Run<Real>{first, n_, n_, rest}, points_);
      correctRun(Run<Real>{first, n_ - 1, n_ + 1, diagonal}, points_);
      correctRun(Run<Real>{first + 1, n_ - 1, n_ - 1, diagonal}, points_);
      correctRun(Run<Real>{first, n_, 2 * n_, 2 * rest}, points_);
    }
  }

 private:
  std::size_t n_;
  Points<Real> points_;
};

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

/// Corrects the springs of a colour. Reads, corrects and writes as many at once as a vector of 32
/// bytes holds.
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

/// Springs by their colours, as if nothing were known of the mesh.
template <typename Real>
class AnySweep {
 public:
  explicit AnySweep(const Packed& packed) {
    const VectorArray& x = packed.particles.x;
    for (std::size_t k = 0; k < x.x.size(); ++k) {
      const Vec3 wavy = x.at(k) + 0.01 * Vec3(x.x[k], std::sin(20.0 * x.x[k]), 2.0 * x.z[k]);
      points_.push_back({static_cast<Real>(wavy.x()), static_cast<Real>(wavy.y()),
                         static_cast<Real>(wavy.z()), Real(0)});
    }
    for (const SpringSchedule::Span& span : packed.schedule.spans()) {
      colours_.push_back({static_cast<std::int32_t>(a_.size()), span.count});
      packed.schedule.visit(span, [&](const SpringSchedule::Element& spring) {
        a_.push_back(spring.a);
        b_.push_back(spring.b);
        rest_.push_back(static_cast<Real>(spring.parameters.restLength));
      });
    }
  }

  std::size_t springs() const { return rest_.size(); }
  void go() {
    for (const auto& [first, count] : colours_) {
      correctColour({static_cast<std::size_t>(count), a_.data() + first, b_.data() + first,
                     rest_.data() + first},
                    points_.data());
    }
  }

 private:
  std::vector<Point<Real>> points_;
  std::vector<std::pair<std::int32_t, std::int32_t>> colours_;
  std::vector<std::int32_t> a_, b_;
  std::vector<Real> rest_;
};

/// The sweep of `xpbd`.
class OwnSweep {
 public:
  explicit OwnSweep(Packed& packed) : packed_(packed) {
    projection_.setMasses(packed.schedule, packed.particles.inverseMass);
    projection_.setStep(packed.schedule, packed.particles.inverseMass, kSubstep);
  }

  std::size_t springs() const { return static_cast<std::size_t>(packed_.schedule.size()); }
  void go() { projection_.project(packed_.schedule, packed_.particles); }

 private:
  Packed& packed_;
  SpringProjection projection_;
};

/// Sweeps as often as makes a turn of a million springs.
template <typename Sweep>
void takeTurn(const std::string& name, Sweep& sweep, Turns& turns) {
  const std::size_t times = 1'000'000 / std::max<std::size_t>(sweep.springs(), 1) + 1;
  const auto go = [&] {
    for (std::size_t k = 0; k < times; ++k) {
      sweep.go();
      benchmark::ClobberMemory();
    }
  };
  turns.time(name, go, static_cast<double>(times * sweep.springs()));
}

/// Times are for one spring.
template <template <typename> class Floor>
void sweeps(benchmark::State& run, Packed& packed) {
  Floor<float> single(packed);
  Floor<double> twice(packed);
  OwnSweep own(packed);
  Turns turns;
  for (auto _ : run) {
    takeTurn("own", own, turns);
    takeTurn("double", twice, turns);
    takeTurn("float", single, turns);
  }
  for (const char* name : {"own", "double", "float"}) run.counters[name] = turns.median(name);
  run.counters["over_double"] = turns.medianOver("own", "double");
  run.counters["over_float"] = turns.medianOver("own", "float");
}

void grid(benchmark::State& run) {
  Packed packed(static_cast<int>(run.range(0)), Order::kGrid);
  sweeps<StructuredSweep>(run, packed);
}

void any(benchmark::State& run) {
  Packed packed(static_cast<int>(run.range(0)), Order::kAny);
  sweeps<AnySweep>(run, packed);
}

/// A grid with an overflow of springs that cuts and refinement made.
void refined(benchmark::State& run) {
  Packed packed(static_cast<int>(run.range(0)), Order::kGrid);
  packed.slit();
  sweeps<AnySweep>(run, packed);
}

const bool kRegistered = [] {
  constexpr int kTurns = 15;
  const auto add = [](const char* name, void (*measure)(benchmark::State&)) {
    return benchmark::RegisterBenchmark(name, measure)
        ->RangeMultiplier(2)
        ->ArgName("side")
        ->Iterations(kTurns)
        ->Unit(benchmark::kMillisecond);
  };
  add("floor/grid", grid)->Range(32, 1024);
  add("floor/any", any)->Range(32, 1024);
  add("floor/refined", refined)->Range(64, 256);
  return true;
}();

}  // namespace
}  // namespace cloth_sim::bench
