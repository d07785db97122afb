#include "later_correction.h"

#include <algorithm>
#include <limits>

#include "cloth_sim/solver/vector_clones.h"
#include "compliance.h"
#include "packed_ops.h"
#include "spring_factor.h"

namespace cloth_sim {
namespace {

/// Of a particle, side by side: one vector.
constexpr std::size_t kNumbers = kLanes;

using LaterSpan = SpringSchedule::Span;
/// Which lanes: those of the first of two are 0 to 3, those of the second 4 to 7.
using LaneOrder = std::int64_t __attribute__((vector_size(kLanes * sizeof(std::int64_t))));

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

/// \param x      of the particles.
/// \param start  ... at the start of the substep; only where there are dashpots.
template <bool kDamped>
[[gnu::always_inline]] inline void correctFour(const FourLater& springs, const double* start,
                                               double* x) {
  std::ptrdiff_t a[kLanes], b[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    a[i] = springs.a[i];
    b[i] = springs.b[i];
  }
  Lanes d[kLanes];
  for (int i = 0; i < kLanes; ++i) d[i] = lanesAt(x + b[i]) - lanesAt(x + a[i]);
  FourOffsets started{};
  if constexpr (kDamped) {
    Lanes from[kLanes];
    for (int i = 0; i < kLanes; ++i) from[i] = lanesAt(start + b[i]) - lanesAt(start + a[i]);
    started = byAxis(from);
  }
  const Lanes f = factorsOf<kDamped>(byAxis(d), lanesAt(springs.rest), lanesAt(springs.give),
                                     lanesAt(springs.lag), started);
  const Lanes fa = f * lanesAt(springs.massA);
  const Lanes fb = f * lanesAt(springs.massB);
  for (int i = 0; i < kLanes; ++i) {
    lanesAt(x + a[i]) += allLanes(fa[i]) * d[i];
    lanesAt(x + b[i]) -= allLanes(fb[i]) * d[i];
  }
}

/// Springs between two particles that move neither.
FourLater doingNothing(std::int32_t a, std::int32_t b) {
  FourLater four{};
  std::fill_n(four.a, kLanes, a);
  std::fill_n(four.b, kLanes, b);
  std::fill_n(four.give, kLanes, std::numeric_limits<double>::infinity());
  return four;
}

CLOTH_SIM_VECTOR_CLONES
void correctElasticLater(const FourLater* four, const FourLater* end, const double* start,
                         double* x) {
  for (; four != end; ++four) correctFour<false>(*four, start, x);
}

CLOTH_SIM_VECTOR_CLONES
void correctDampedLater(const FourLater* four, const FourLater* end, const double* start,
                        double* x) {
  for (; four != end; ++four) correctFour<true>(*four, start, x);
}

}  // namespace

void LaterCorrection::setMasses(const SpringSchedule& schedule, const PackedScalars& inverseMass) {
  listParticles(schedule, inverseMass.size());
  fours_.clear();
  begins_.clear();
  for (std::size_t s = schedule.firstLater(); s < schedule.spans().size(); ++s) {
    begins_.push_back(fours_.size());
    std::int32_t lane = 0;
    schedule.visit(schedule.spans()[s], [&](const SpringSchedule::Element& spring) {
      if (lane == 0) fours_.push_back(doingNothing(places_[spring.a], places_[spring.b]));
      FourLater& four = fours_.back();
      four.a[lane] = places_[spring.a];
      four.b[lane] = places_[spring.b];
      four.massA[lane] = inverseMass[spring.a];
      four.massB[lane] = inverseMass[spring.b];
      four.rest[lane] = spring.law.restLength;
      lane = (lane + 1) % kLanes;
    });
  }
  begins_.push_back(fours_.size());
}

void LaterCorrection::listParticles(const SpringSchedule& schedule, std::size_t slots) {
  places_.assign(slots, kNone);
  for (std::size_t s = schedule.firstLater(); s < schedule.spans().size(); ++s) {
    schedule.visit(schedule.spans()[s], [&](const SpringSchedule::Element& spring) {
      places_[spring.a] = places_[spring.b] = 0;
    });
  }
  slots_.clear();
  for (std::size_t slot = 0; slot < slots; ++slot) {
    if (places_[slot] == kNone) continue;
    places_[slot] = static_cast<std::int32_t>(kNumbers * slots_.size());
    slots_.push_back(static_cast<std::int32_t>(slot));
  }
  x_.assign(kNumbers * slots_.size(), 0.0);
  start_.assign(schedule.laws.damped() ? x_.size() : 0, 0.0);
}

void LaterCorrection::setStep(const SpringSchedule& schedule, double h) {
  for (std::size_t s = schedule.firstLater(); s < schedule.spans().size(); ++s) {
    const LaterSpan& span = schedule.spans()[s];
    FourLater* const fours = fours_.data() + begins_[s - schedule.firstLater()];
    schedule.visit(span, [&](const SpringSchedule::Element& spring) {
      const std::int32_t k = spring.position - span.first;
      const std::int32_t lane = k % kLanes;
      FourLater& four = fours[k / kLanes];
      const Compliance of = complianceOf(spring.law, h);
      four.give[lane] = giveOf(four.massA[lane] + four.massB[lane], of.alpha, of.lag);
      four.lag[lane] = of.lag;
    });
  }
}

void LaterCorrection::correct(const SpringSchedule& schedule, PackedParticles& particles) {
  if (slots_.empty()) return;
  gather(particles);
  const auto correctFours = start_.empty() ? correctElasticLater : correctDampedLater;
  const LaterSpan* const first = schedule.spans().data() + schedule.firstLater();
  schedule.sweepLater([&](const LaterSpan* span, const LaterSpan* end) {
    correctFours(fours_.data() + begins_[span - first], fours_.data() + begins_[end - first],
                 start_.data(), x_.data());
  });
  scatter(particles);
}

void LaterCorrection::gather(const PackedParticles& p) {
  const auto copy = [this](const PackedVectors& from, PackedScalars& to) {
    forParts(slots_.size(), [&](std::size_t first, std::size_t count) {
      for (std::size_t k = first; k < first + count; ++k) {
        double* const at = to.data() + kNumbers * k;
        at[0] = from.x[slots_[k]];
        at[1] = from.y[slots_[k]];
        at[2] = from.z[slots_[k]];
      }
    });
  };
  copy(p.x, x_);
  if (!start_.empty()) copy(p.start, start_);
}

void LaterCorrection::scatter(PackedParticles& p) const {
  forParts(slots_.size(), [&](std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) {
      const double* const at = x_.data() + kNumbers * k;
      p.x.x[slots_[k]] = at[0];
      p.x.y[slots_[k]] = at[1];
      p.x.z[slots_[k]] = at[2];
    }
  });
}

}  // namespace cloth_sim
