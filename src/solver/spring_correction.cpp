#include "spring_correction.h"

#include <cmath>
#include <limits>

#include "cloth_sim/solver/vector_clones.h"

namespace cloth_sim {
namespace {

using Span = SpringSchedule::Span;

/// Particles from some slot on.
struct Points {
  double* x;
  double* y;
  double* z;
  const double* sx;
  const double* sy;
  const double* sz;
  const double* w;
};

Points allPoints(PackedParticles& p) {
  return {p.x.x.data(),     p.x.y.data(),     p.x.z.data(),        p.start.x.data(),
          p.start.y.data(), p.start.z.data(), p.inverseMass.data()};
}

[[gnu::always_inline]] inline Points from(const Points& p, std::int32_t slot) {
  return {p.x + slot, p.y + slot, p.z + slot, p.sx + slot, p.sy + slot, p.sz + slot, p.w + slot};
}

/// From end a to end b.
struct Offset {
  double x, y, z;
};

[[gnu::always_inline]] inline Offset offset(const Points& a, std::int32_t i, const Points& b,
                                            std::int32_t j) {
  return {b.x[j] - a.x[i], b.y[j] - a.y[i], b.z[j] - a.z[i]};
}

[[gnu::always_inline]] inline Offset startOffset(const Points& a, std::int32_t i, const Points& b,
                                                 std::int32_t j) {
  return {b.sx[j] - a.sx[i], b.sy[j] - a.sy[i], b.sz[j] - a.sz[i]};
}

/// The correction of a spring over its offset [kg].
/// \param w  of both ends together.
[[gnu::always_inline]] inline double correction(const Offset& d, double w, double rest,
                                                double alpha) {
  const double length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z + kTinySquare);
  return (length - rest) / (length * (w + alpha));
}

[[gnu::always_inline]] inline double dampedCorrection(const Offset& d, const Offset& start,
                                                      double w, double rest, double alpha,
                                                      double lag) {
  const double squared = d.x * d.x + d.y * d.y + d.z * d.z + kTinySquare;
  const double length = std::sqrt(squared);
  const double moved = (squared - d.x * start.x - d.y * start.y - d.z * start.z) / length;
  return (length - rest + lag * moved) / (length * ((1.0 + lag) * w + alpha));
}

/// Moves end i of `a` and end j of `b` by the correction f over their offset.
[[gnu::always_inline]] inline void moveEnds(const Points& a, std::int32_t i, const Points& b,
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

/// What sweeps read of springs.
struct Springs {
  const std::int32_t* a;
  const std::int32_t* b;
  const double* rest;
  const double* alpha;
  const double* lag;
};

/// The laws of the springs of a span, `kStride` apart: 0 if all have the same.
template <int kStride, bool kDamped>
[[gnu::always_inline]] inline void correctRun(const Span& span, const Springs& springs,
                                              const Points& points) {
  const Points a = from(points, span.ends.a);
  const Points b = from(points, span.ends.b);
  const double* const rest = springs.rest + span.laws;
  const double* const alpha = springs.alpha + span.laws;
  const double* const lag = kDamped ? springs.lag + span.laws : nullptr;
  const std::int32_t count = span.count;
#pragma GCC ivdep
  for (std::int32_t k = 0; k < count; ++k) {
    const Offset d = offset(a, k, b, k);
    const double w = a.w[k] + b.w[k];
    const std::int32_t law = kStride * k;
    const double f =
        kDamped ? dampedCorrection(d, startOffset(a, k, b, k), w, rest[law], alpha[law], lag[law])
                : correction(d, w, rest[law], alpha[law]);
    moveEnds(a, k, b, k, d, f);
  }
}

/// `kLanes` springs, none of which share a particle: gathered, corrected at once, scattered.
template <int kLanes, bool kDamped>
[[gnu::always_inline]] inline void correctOthers(const Springs& springs, const Points& p) {
  Offset d[kLanes];
  Offset start[kLanes];
  double w[kLanes];
  double f[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::int32_t a = springs.a[lane];
    const std::int32_t b = springs.b[lane];
    d[lane] = offset(p, a, p, b);
    w[lane] = p.w[a] + p.w[b];
    if (kDamped) start[lane] = startOffset(p, a, p, b);
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    const double rest = springs.rest[lane];
    const double alpha = springs.alpha[lane];
    f[lane] = kDamped
                  ? dampedCorrection(d[lane], start[lane], w[lane], rest, alpha, springs.lag[lane])
                  : correction(d[lane], w[lane], rest, alpha);
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    moveEnds(p, springs.a[lane], p, springs.b[lane], d[lane], f[lane]);
  }
}

/// Springs of a span whose ends are anywhere.
template <bool kDamped>
[[gnu::always_inline]] inline void correctAnywhere(const Span& span, const Springs& springs,
                                                   const Points& points) {
  constexpr int kLanes = 4;
  const auto at = [&](std::int32_t k) -> Springs {
    const std::int32_t other = span.others + k;
    const std::int32_t law = span.laws + k;
    return {springs.a + other, springs.b + other, springs.rest + law, springs.alpha + law,
            kDamped ? springs.lag + law : nullptr};
  };
  std::int32_t k = 0;
  for (; k + kLanes <= span.count; k += kLanes) correctOthers<kLanes, kDamped>(at(k), points);
  for (; k < span.count; ++k) correctOthers<1, kDamped>(at(k), points);
}

template <bool kDamped>
[[gnu::always_inline]] inline void correctSpans(const Span* span, const Span* end,
                                                const Springs& springs, const Points& points) {
  for (; span != end; ++span) {
    if (span->isUniform) {
      correctRun<0, kDamped>(*span, springs, points);
    } else if (span->isRun) {
      correctRun<1, kDamped>(*span, springs, points);
    } else {
      correctAnywhere<kDamped>(*span, springs, points);
    }
  }
}

CLOTH_SIM_VECTOR_CLONES
void sweepElastic(const Span* span, const Span* end, const Springs& springs, const Points& points) {
  correctSpans<false>(span, end, springs, points);
}

CLOTH_SIM_VECTOR_CLONES
void sweepDamped(const Span* span, const Span* end, const Springs& springs, const Points& points) {
  correctSpans<true>(span, end, springs, points);
}

}  // namespace

Compliance complianceOf(const SpringLaw& law, double h) {
  if (law.stiffness <= 0.0) return {std::numeric_limits<double>::infinity(), 0.0};
  return {1.0 / (law.stiffness * h * h), law.damping / (law.stiffness * h)};
}

void setCompliances(const SpringLaws& laws, double h, Compliances& compliances) {
  compliances.alpha.resize(laws.size());
  compliances.lag.resize(laws.damped() ? laws.size() : 0);
  for (std::size_t k = 0; k < laws.size(); ++k) {
    const Compliance of = complianceOf(laws[static_cast<std::int32_t>(k)], h);
    compliances.alpha[k] = of.alpha;
    if (laws.damped()) compliances.lag[k] = of.lag;
  }
}

void correctSprings(const SpringSchedule& schedule, const Compliances& compliances,
                    PackedParticles& particles) {
  const Springs springs{schedule.endA.data(), schedule.endB.data(),
                        schedule.laws.restLength().data(), compliances.alpha.data(),
                        compliances.lag.data()};
  const Points points = allPoints(particles);
  const auto sweep = schedule.laws.damped() ? sweepDamped : sweepElastic;
  schedule.sweepSpans(
      [&](const Span* first, const Span* end) { sweep(first, end, springs, points); });
}

}  // namespace cloth_sim
