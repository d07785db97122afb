#include "spring_correction.h"

#include <cmath>

#include "cloth_sim/solver/vector_clones.h"

namespace cloth_sim {
namespace {

struct Ends {
  double* x;
  double* y;
  double* z;
  const double* sx;
  const double* sy;
  const double* sz;
  const double* w;
};

Ends endsAt(PackedParticles& p, std::int32_t slot) {
  return {p.x.x.data() + slot,        p.x.y.data() + slot,     p.x.z.data() + slot,
          p.start.x.data() + slot,    p.start.y.data() + slot, p.start.z.data() + slot,
          p.inverseMass.data() + slot};
}

/// From end a to end b, now and at the start of the substep.
struct Offset {
  double x, y, z;
  double startX, startY, startZ;
};

/// The correction of a spring over its offset [kg].
[[gnu::always_inline]] inline double correction(const Offset& d, double rest, double gain) {
  const double length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z + kTinySquare);
  return gain - gain * rest / length;
}

[[gnu::always_inline]] inline double dampedCorrection(const Offset& d, double rest, double gain,
                                                      double lag) {
  const double squared = d.x * d.x + d.y * d.y + d.z * d.z + kTinySquare;
  const double length = std::sqrt(squared);
  const double moved = squared - d.x * d.startX - d.y * d.startY - d.z * d.startZ;
  const double inverse = 1.0 / length;
  return gain * (length - rest + lag * (moved * inverse)) * inverse;
}

/// Moves end i of `a` and end j of `b` by the correction f over their offset.
[[gnu::always_inline]] inline void moveEnds(const Ends& a, std::int32_t i, const Ends& b,
                                            std::int32_t j, const Offset& d, double f) {
  const double fa = f * a.w[i];
  const double fb = f * b.w[j];
  a.x[i] += fa * d.x;
  a.y[i] += fa * d.y;
  a.z[i] += fa * d.z;
  b.x[j] -= fb * d.x;
  b.y[j] -= fb * d.y;
  b.z[j] -= fb * d.z;
}

CLOTH_SIM_VECTOR_CLONES
void sweepRun(std::int32_t count, Ends a, Ends b, const double* rest, const double* gain) {
#pragma GCC ivdep
  for (std::int32_t k = 0; k < count; ++k) {
    const Offset d{b.x[k] - a.x[k], b.y[k] - a.y[k], b.z[k] - a.z[k], 0.0, 0.0, 0.0};
    moveEnds(a, k, b, k, d, correction(d, rest[k], gain[k]));
  }
}

CLOTH_SIM_VECTOR_CLONES
void sweepDampedRun(std::int32_t count, Ends a, Ends b, const double* rest, const double* gain,
                    const double* lag) {
#pragma GCC ivdep
  for (std::int32_t k = 0; k < count; ++k) {
    const Offset d{b.x[k] - a.x[k],   b.y[k] - a.y[k],   b.z[k] - a.z[k],
                   b.sx[k] - a.sx[k], b.sy[k] - a.sy[k], b.sz[k] - a.sz[k]};
    moveEnds(a, k, b, k, d, dampedCorrection(d, rest[k], gain[k], lag[k]));
  }
}

/// Springs whose ends are anywhere.
struct Others {
  const std::int32_t* a;
  const std::int32_t* b;
  const double* rest;
  const double* gain;
  const double* lag;
};

/// `kLanes` springs, none of which share a particle: gathered, corrected at once, scattered.
template <int kLanes, bool kDamped>
[[gnu::always_inline]] inline void correctOthers(std::int32_t k, const Others& springs,
                                                 const Ends& p) {
  Offset d[kLanes];
  double f[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::int32_t a = springs.a[k + lane];
    const std::int32_t b = springs.b[k + lane];
    d[lane] = {p.x[b] - p.x[a], p.y[b] - p.y[a], p.z[b] - p.z[a], 0.0, 0.0, 0.0};
    if (!kDamped) continue;
    d[lane].startX = p.sx[b] - p.sx[a];
    d[lane].startY = p.sy[b] - p.sy[a];
    d[lane].startZ = p.sz[b] - p.sz[a];
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    const double rest = springs.rest[k + lane];
    const double gain = springs.gain[k + lane];
    f[lane] = kDamped ? dampedCorrection(d[lane], rest, gain, springs.lag[k + lane])
                      : correction(d[lane], rest, gain);
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    moveEnds(p, springs.a[k + lane], p, springs.b[k + lane], d[lane], f[lane]);
  }
}

template <bool kDamped>
[[gnu::always_inline]] inline void sweepAll(std::int32_t count, const Others& springs,
                                            const Ends& particles) {
  constexpr int kLanes = 4;
  std::int32_t k = 0;
  for (; k + kLanes <= count; k += kLanes) correctOthers<kLanes, kDamped>(k, springs, particles);
  for (; k < count; ++k) correctOthers<1, kDamped>(k, springs, particles);
}

CLOTH_SIM_VECTOR_CLONES
void sweepOthers(std::int32_t count, Others springs, Ends particles) {
  sweepAll<false>(count, springs, particles);
}

CLOTH_SIM_VECTOR_CLONES
void sweepDampedOthers(std::int32_t count, Others springs, Ends particles) {
  sweepAll<true>(count, springs, particles);
}

}  // namespace

void setGains(const SpringSchedule& schedule, const std::vector<double>& inverseMass, double h,
              SpringGains& gains) {
  const auto n = static_cast<std::size_t>(schedule.size());
  gains.gain.assign(n, 0.0);
  gains.lag.assign(schedule.damped ? n : 0, 0.0);
  for (std::size_t p = 0; p < n; ++p) {
    const double stiffness = schedule.stiffness[p];
    if (stiffness <= 0.0) continue;
    const double w = inverseMass[schedule.endA[p]] + inverseMass[schedule.endB[p]];
    const double lag = schedule.dampingAt(static_cast<std::int32_t>(p)) / (stiffness * h);
    if (schedule.damped) gains.lag[p] = lag;
    gains.gain[p] = 1.0 / ((1.0 + lag) * w + 1.0 / (stiffness * h * h));
  }
}

void correctSprings(const SpringSchedule& s, const SpringGains& gains, PackedParticles& particles) {
  const auto correctRun = [&](std::int32_t first, std::int32_t count) {
    const Ends a = endsAt(particles, s.endA[first]);
    const Ends b = endsAt(particles, s.endB[first]);
    const double* const rest = s.restLength.data() + first;
    const double* const gain = gains.gain.data() + first;
    if (s.damped) {
      sweepDampedRun(count, a, b, rest, gain, gains.lag.data() + first);
    } else {
      sweepRun(count, a, b, rest, gain);
    }
  };
  const auto correctOthers = [&](std::int32_t first, std::int32_t count) {
    const Others others{s.endA.data() + first, s.endB.data() + first, s.restLength.data() + first,
                        gains.gain.data() + first, s.damped ? gains.lag.data() + first : nullptr};
    const Ends all = endsAt(particles, 0);
    s.damped ? sweepDampedOthers(count, others, all) : sweepOthers(count, others, all);
  };
  s.sweep(correctRun, correctOthers);
}

}  // namespace cloth_sim
