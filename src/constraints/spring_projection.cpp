#include "spring_projection.h"

#include <algorithm>

#include "spring_factor.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

using Span = SpringSchedule::Span;

/// Some that follow each other.
struct Spans {
  const Span* begin;
  const Span* end;
  const UniformMassRange* even;  ///< of the first and those after it
};

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

Points allPoints(Particles& p) {
  return {p.x.x.data(),     p.x.y.data(),     p.x.z.data(),        p.start.x.data(),
          p.start.y.data(), p.start.z.data(), p.inverseMass.data()};
}

[[gnu::always_inline]] inline Points from(const Points& p, std::int32_t slot) {
  return {p.x + slot, p.y + slot, p.z + slot, p.sx + slot, p.sy + slot, p.sz + slot, p.w + slot};
}

/// What sweeps read of springs, from some spring on; ends only of those that are in no run.
struct Springs {
  const std::int32_t* a;
  const std::int32_t* b;
  const double* rest;
  const double* alpha;
  const double* lag;
};

template <bool kDamped>
[[gnu::always_inline]] inline Springs after(const Springs& s, std::int32_t ends,
                                            std::int32_t parameters) {
  return {s.a + ends, s.b + ends, s.rest + parameters, s.alpha + parameters,
          kDamped ? s.lag + parameters : nullptr};
}

struct Ends {
  Lanes x, y, z;
};

/// Inverse masses of the ends of four springs.
struct Masses {
  Lanes a, b;
};

struct FourLaws {
  Lanes rest, alpha;
  Lanes lag;  ///< only where there are dashpots
};

/// Four springs none of which share a particle.
struct Four {
  Ends a, b;
  Masses w;
  FourLaws parameters;
  FourOffsets start;  ///< at the start of the substep; only where there are dashpots
};

/// Moves both ends of each spring.
template <bool kDamped>
[[gnu::always_inline]] inline void correct(Four& s) {
  const FourOffsets d{s.b.x - s.a.x, s.b.y - s.a.y, s.b.z - s.a.z};
  const Lanes w = s.w.a + s.w.b;
  const Lanes give =
      kDamped ? giveOf(w, s.parameters.alpha, s.parameters.lag) : w + s.parameters.alpha;
  const Lanes f = factorsOf<kDamped>(d, s.parameters.rest, give, s.parameters.lag, s.start);
  const Lanes fa = f * s.w.a;
  const Lanes fb = f * s.w.b;
  s.a.x += fa * d.x;
  s.a.y += fa * d.y;
  s.a.z += fa * d.z;
  s.b.x -= fb * d.x;
  s.b.y -= fb * d.y;
  s.b.z -= fb * d.z;
}

/// The parameters of four springs from the k-th on.
template <bool kDamped>
[[gnu::always_inline]] inline FourLaws lawsOf(const Springs& springs, std::ptrdiff_t k) {
  FourLaws parameters;
  parameters.rest = lanesAt(springs.rest + k);
  parameters.alpha = lanesAt(springs.alpha + k);
  if (kDamped) parameters.lag = lanesAt(springs.lag + k);
  return parameters;
}

/// The parameters of the first spring, four times.
template <bool kDamped>
[[gnu::always_inline]] inline FourLaws oneLaw(const Springs& springs) {
  FourLaws parameters;
  parameters.rest = allLanes(*springs.rest);
  parameters.alpha = allLanes(*springs.alpha);
  if (kDamped) parameters.lag = allLanes(*springs.lag);
  return parameters;
}

/// The springs of a run from the k-th on, corrected but not yet written.
/// \param a, b   from the first spring's ends on.
template <bool kDamped>
[[gnu::always_inline]] inline Four corrected(const Points& a, const Points& b,
                                             const FourLaws& parameters, const Masses& w,
                                             std::ptrdiff_t k) {
  Four s;
  s.a = {lanesAt(a.x + k), lanesAt(a.y + k), lanesAt(a.z + k)};
  s.b = {lanesAt(b.x + k), lanesAt(b.y + k), lanesAt(b.z + k)};
  s.w = w;
  s.parameters = parameters;
  if (kDamped) {
    s.start = {lanesAt(b.sx + k) - lanesAt(a.sx + k), lanesAt(b.sy + k) - lanesAt(a.sy + k),
               lanesAt(b.sz + k) - lanesAt(a.sz + k)};
  }
  correct<kDamped>(s);
  return s;
}

[[gnu::always_inline]] inline void write(const Ends& ends, const Points& to, std::ptrdiff_t k) {
  lanesAt(to.x + k) = ends.x;
  lanesAt(to.y + k) = ends.y;
  lanesAt(to.z + k) = ends.z;
}

/// Springs whose ends follow each other; of one parameters if `kUniform`.
template <bool kUniform, bool kDamped>
[[gnu::always_inline]] inline void correctRun(const Span& span, const UniformMassRange& even,
                                              const Springs& springs, const Points& points) {
  static_assert(SpringSchedule::kShortestRun >= kLanes);
  const Points a = from(points, span.ends.a);
  const Points b = from(points, span.ends.b);
  const FourLaws parameters = oneLaw<kDamped>(springs);
  const auto with = [&](const Masses& w, std::ptrdiff_t k) __attribute__((always_inline)) {
    return corrected<kDamped>(a, b, kUniform ? parameters : lawsOf<kDamped>(springs, k), w, k);
  };
  const auto at = [&](std::ptrdiff_t k) __attribute__((always_inline)) {
    return with({lanesAt(a.w + k), lanesAt(b.w + k)}, k);
  };
  const auto correctFours = [&](std::ptrdiff_t k, std::ptrdiff_t end, const auto& four)
      __attribute__((always_inline)) {
    for (; k < end; k += kLanes) {
      const Four s = four(k);
      write(s.a, a, k);
      write(s.b, b, k);
    }
  };
  const auto correctUntil = [&](std::ptrdiff_t end) __attribute__((always_inline)) {
    const Lanes w = allLanes(a.w[even.from]);
    correctFours(0, even.from, at);
    correctFours(
        even.from, even.end, [&](std::ptrdiff_t k) __attribute__((always_inline)) {
          return with({w, w}, k);
        });
    correctFours(even.end, end, at);
  };
  if (span.count % kLanes == 0) return correctUntil(span.count);
  // The last four overlap the four before them: they are read before, and written after them.
  const std::ptrdiff_t last = span.count - kLanes;
  const Four rest = at(last);
  correctUntil(last);
  write(rest.a, a, last);
  write(rest.b, b, last);
}

[[gnu::always_inline]] inline Ends gatherEnds(const Points& p, const std::int32_t* slots) {
  return {gather(p.x, slots), gather(p.y, slots), gather(p.z, slots)};
}

[[gnu::always_inline]] inline FourOffsets gatherStart(const Points& p, const std::int32_t* a,
                                                      const std::int32_t* b) {
  return {gather(p.sx, b) - gather(p.sx, a), gather(p.sy, b) - gather(p.sy, a),
          gather(p.sz, b) - gather(p.sz, a)};
}

[[gnu::always_inline]] inline void scatterEnds(const Ends& ends, const Points& p,
                                               const std::int32_t* slots) {
  scatter(ends.x, p.x, slots);
  scatter(ends.y, p.y, slots);
  scatter(ends.z, p.z, slots);
}

/// The first four springs.
template <bool kDamped>
[[gnu::always_inline]] inline void correctFour(const Springs& springs, const Points& p) {
  Four s;
  s.a = gatherEnds(p, springs.a);
  s.b = gatherEnds(p, springs.b);
  s.w = {gather(p.w, springs.a), gather(p.w, springs.b)};
  s.parameters = lawsOf<kDamped>(springs, 0);
  if (kDamped) s.start = gatherStart(p, springs.a, springs.b);
  correct<kDamped>(s);
  scatterEnds(s.a, p, springs.a);
  scatterEnds(s.b, p, springs.b);
}

/// Fewer than four springs, and the last of them again: what is done twice to the same positions is
/// written twice.
template <bool kDamped>
[[gnu::always_inline]] inline void correctRest(const Springs& springs, std::int32_t count,
                                               const Points& p) {
  std::int32_t a[kLanes], b[kLanes];
  double rest[kLanes], alpha[kLanes], lag[kLanes];
  for (std::int32_t lane = 0; lane < kLanes; ++lane) {
    const std::int32_t k = std::min(lane, count - 1);
    a[lane] = springs.a[k];
    b[lane] = springs.b[k];
    rest[lane] = springs.rest[k];
    alpha[lane] = springs.alpha[k];
    if (kDamped) lag[lane] = springs.lag[k];
  }
  correctFour<kDamped>({a, b, rest, alpha, lag}, p);
}

/// Springs whose ends are anywhere.
template <bool kDamped>
[[gnu::always_inline]] inline void correctAnywhere(const Span& span, Springs springs,
                                                   const Points& p) {
  std::int32_t left = span.count;
  for (; left >= kLanes; left -= kLanes) {
    correctFour<kDamped>(springs, p);
    springs = after<kDamped>(springs, kLanes, kLanes);
  }
  if (left > 0) correctRest<kDamped>(springs, left, p);
}

template <bool kDamped>
[[gnu::always_inline]] inline void correctSpans(const Spans& spans, const Springs& springs,
                                                const Points& points) {
  const UniformMassRange* even = spans.even;
  for (const Span* span = spans.begin; span != spans.end; ++span, ++even) {
    const Springs of = after<kDamped>(springs, span->others, span->firstParameters);
    if (span->isUniform) {
      correctRun<true, kDamped>(*span, *even, of, points);
    } else if (span->isRun) {
      correctRun<false, kDamped>(*span, *even, of, points);
    } else {
      correctAnywhere<kDamped>(*span, of, points);
    }
  }
}

CLOTH_SIM_VECTOR_CLONES
void sweepElastic(const Spans& spans, const Springs& springs, const Points& points) {
  correctSpans<false>(spans, springs, points);
}

CLOTH_SIM_VECTOR_CLONES
void sweepDamped(const Spans& spans, const Springs& springs, const Points& points) {
  correctSpans<true>(spans, springs, points);
}

}  // namespace

void SpringProjection::setMasses(const SpringSchedule& schedule, const ScalarArray& inverseMass) {
  findUniformMassRanges(schedule, inverseMass, even_);
  later_.setMasses(schedule, inverseMass);
}

void SpringProjection::setStep(const SpringSchedule& schedule, double h) {
  setCompliances(schedule.parameters, h, compliances_);
  later_.setStep(schedule, compliances_);
}

void SpringProjection::correct(const SpringSchedule& schedule, Particles& particles,
                               const Prepare& prepare) {
  const Springs springs{schedule.endA.data(), schedule.endB.data(),
                        schedule.parameters.restLength().data(), compliances_.alpha.data(),
                        compliances_.lag.data()};
  const Points points = allPoints(particles);
  const auto sweep = schedule.parameters.damped() ? sweepDamped : sweepElastic;
  const auto visit = [&](const Span* first, const Span* end) {
    sweep({first, end, even_.data() + (first - schedule.spans().data())}, springs, points);
  };
  prepare ? schedule.sweepOriginals(particles.slots, prepare, visit)
          : schedule.sweepOriginals(visit);
  later_.correct(schedule, particles);
}

}  // namespace cloth_sim
