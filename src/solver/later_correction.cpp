#include "later_correction.h"

#include <algorithm>
#include <limits>

#include "cloth_sim/solver/vector_clones.h"
#include "packed_ops.h"
#include "spring_factor.h"

namespace cloth_sim {
namespace {

using LaterSpan = SpringSchedule::Span;
/// Which lanes: those of the first of two are 0 to 3, those of the second 4 to 7.
using LaneOrder = std::int64_t __attribute__((vector_size(kLanes * sizeof(std::int64_t))));

/// Springs from some one on, and the particles.
struct Later {
  FourNumbers* x;            ///< by place
  const FourNumbers* start;  ///< ... at the start of the substep; only where there are dashpots
  const std::int32_t* a;     ///< places
  const std::int32_t* b;
  const double* rest;
  const double* alpha;
  const double* lag;  ///< only where there are dashpots
};

[[gnu::always_inline]] inline Lanes& lanesOf(FourNumbers& of) { return lanesAt(&of.x); }
[[gnu::always_inline]] inline const Lanes& lanesOf(const FourNumbers& of) { return lanesAt(&of.x); }

/// From particles side by side to axes side by side.
[[gnu::always_inline]] inline FourOffsets byAxis(const Lanes (&of)[kLanes]) {
  const Lanes xz01 = __builtin_shuffle(of[0], of[1], LaneOrder{0, 4, 2, 6});
  const Lanes xz23 = __builtin_shuffle(of[2], of[3], LaneOrder{0, 4, 2, 6});
  const Lanes y01 = __builtin_shuffle(of[0], of[1], LaneOrder{1, 5, 3, 7});
  const Lanes y23 = __builtin_shuffle(of[2], of[3], LaneOrder{1, 5, 3, 7});
  return {__builtin_shuffle(xz01, xz23, LaneOrder{0, 1, 4, 5}),
          __builtin_shuffle(y01, y23, LaneOrder{0, 1, 4, 5}),
          __builtin_shuffle(xz01, xz23, LaneOrder{2, 3, 6, 7})};
}

/// The first four springs, none of which share a particle.
template <bool kDamped>
[[gnu::always_inline]] inline void correctFourGathered(const Later& springs) {
  const std::int32_t* const a = springs.a;
  const std::int32_t* const b = springs.b;
  FourNumbers* const x = springs.x;
  Lanes d[kLanes];
  for (int k = 0; k < kLanes; ++k) d[k] = lanesOf(x[b[k]]) - lanesOf(x[a[k]]);
  FourOffsets start{};
  if constexpr (kDamped) {
    const FourNumbers* const from = springs.start;
    Lanes moved[kLanes];
    for (int k = 0; k < kLanes; ++k) moved[k] = lanesOf(from[b[k]]) - lanesOf(from[a[k]]);
    start = byAxis(moved);
  }
  const Lanes wa{x[a[0]].w, x[a[1]].w, x[a[2]].w, x[a[3]].w};
  const Lanes wb{x[b[0]].w, x[b[1]].w, x[b[2]].w, x[b[3]].w};
  const FourLaws law = fourLawsAt<kDamped>(springs.rest, springs.alpha, springs.lag);
  const Lanes f = factorsOf<kDamped>(byAxis(d), wa + wb, law, start);
  const Lanes fa = f * wa;
  const Lanes fb = f * wb;
  for (int k = 0; k < kLanes; ++k) {
    const Lanes offset = __builtin_shuffle(d[k], Lanes{}, LaneOrder{0, 1, 2, 7});  // not of masses
    lanesOf(x[a[k]]) += allLanes(fa[k]) * offset;
    lanesOf(x[b[k]]) -= allLanes(fb[k]) * offset;
  }
}

/// Fewer than four springs, and the last of them again, but as if it were gone.
template <bool kDamped>
[[gnu::always_inline]] inline void correctRestGathered(const Later& springs, std::int32_t count) {
  FilledFour four = filledFour<kDamped>(springs, count);
  std::fill(four.alpha + count, four.alpha + kLanes, std::numeric_limits<double>::infinity());
  correctFourGathered<kDamped>(
      {springs.x, springs.start, four.a, four.b, four.rest, four.alpha, four.lag});
}

template <bool kDamped>
[[gnu::always_inline]] inline void correctAll(Later springs, std::int32_t count) {
  for (; count >= kLanes; count -= kLanes) {
    correctFourGathered<kDamped>(springs);
    springs.a += kLanes;
    springs.b += kLanes;
    springs.rest += kLanes;
    springs.alpha += kLanes;
    if (kDamped) springs.lag += kLanes;
  }
  if (count > 0) correctRestGathered<kDamped>(springs, count);
}

CLOTH_SIM_VECTOR_CLONES
void correctElasticLater(const Later& springs, std::int32_t count) {
  correctAll<false>(springs, count);
}

CLOTH_SIM_VECTOR_CLONES
void correctDampedLater(const Later& springs, std::int32_t count) {
  correctAll<true>(springs, count);
}

using ParticleSlots = std::vector<std::int32_t>;

void gatherParticles(const ParticleSlots& slots, bool damped, PackedParticles& p) {
  p.gathered.resize(slots.size());
  p.gatheredStart.resize(damped ? slots.size() : 0);
  forParts(slots.size(), [&](std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) {
      const auto slot = static_cast<std::size_t>(slots[k]);
      p.gathered[k] = {p.x.x[slot], p.x.y[slot], p.x.z[slot], p.inverseMass[slot]};
      if (!damped) continue;
      p.gatheredStart[k] = {p.start.x[slot], p.start.y[slot], p.start.z[slot], 0.0};
    }
  });
}

void scatterParticles(const ParticleSlots& slots, PackedParticles& p) {
  forParts(slots.size(), [&](std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) {
      const auto slot = static_cast<std::size_t>(slots[k]);
      p.x.x[slot] = p.gathered[k].x;
      p.x.y[slot] = p.gathered[k].y;
      p.x.z[slot] = p.gathered[k].z;
    }
  });
}

}  // namespace

void correctLaterSprings(const SpringSchedule& schedule, const Compliances& compliances,
                         PackedParticles& particles) {
  const SpringLaws& laws = schedule.laws;
  const bool damped = laws.damped();
  gatherParticles(schedule.laterSlots(), damped, particles);
  const auto correct = damped ? correctDampedLater : correctElasticLater;
  schedule.sweepLater([&](const LaterSpan* span, const LaterSpan* end) {
    for (; span != end; ++span) {
      correct({particles.gathered.data(), particles.gatheredStart.data(), schedule.laterA(*span),
               schedule.laterB(*span), laws.restLength().data() + span->laws,
               compliances.alpha.data() + span->laws,
               damped ? compliances.lag.data() + span->laws : nullptr},
              span->count);
    }
  });
  scatterParticles(schedule.laterSlots(), particles);
}

}  // namespace cloth_sim
