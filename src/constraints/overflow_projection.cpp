#include "overflow_projection.h"

#include <algorithm>
#include <limits>

#include "compliance.h"
#include "linalg/vector_operations.h"
#include "spring_factor.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

/// Of a particle, side by side: one vector.
constexpr std::size_t kNumbers = kLanes;
constexpr int kMass = 3;

using LaterSpan = SpringSchedule::Span;
using LaneBits = std::int64_t __attribute__((vector_size(kLanes * sizeof(std::int64_t))));
/// Which lanes: those of the first of two are 0 to 3, those of the second 4 to 7.
using LaneOrder = LaneBits;

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

/// Zero in place of the mass.
[[gnu::always_inline]] inline Lanes coordinatesOf(const Lanes& numbers) {
  constexpr LaneBits kCoordinates{-1, -1, -1, 0};
  return reinterpret_cast<Lanes>(reinterpret_cast<LaneBits>(numbers) & kCoordinates);
}

[[gnu::always_inline]] inline FourOffsets offsetsOf(const FourLater& springs, const double* x) {
  Lanes d[kLanes];
  for (int i = 0; i < kLanes; ++i) d[i] = lanesAt(x + springs.b[i]) - lanesAt(x + springs.a[i]);
  return byAxis(d);
}

/// \param x      of the particles.
/// \param start  ... at the start of the substep; only where there are dashpots, as `lag`.
template <bool kDamped>
[[gnu::always_inline]] inline Lanes factorsOf(const FourLater& springs, const double* lag,
                                              const double* start, const double* x) {
  const FourOffsets started = kDamped ? offsetsOf(springs, start) : FourOffsets{};
  return factorsOf<kDamped>(offsetsOf(springs, x), lanesAt(springs.rest), lanesAt(springs.give),
                            kDamped ? lanesAt(lag) : Lanes{}, started);
}

[[gnu::always_inline]] inline void apply(const double* factors, const FourLater& springs,
                                         double* x) {
  for (int i = 0; i < kLanes; ++i) {
    double* const a = x + springs.a[i];
    double* const b = x + springs.b[i];
    const Lanes d = coordinatesOf(lanesAt(b) - lanesAt(a));
    const double fa = factors[i] * a[kMass];
    const double fb = factors[i] * b[kMass];
    lanesAt(a) += allLanes(fa) * d;
    lanesAt(b) -= allLanes(fb) * d;
  }
}

/// Springs of one colour. Their factors take long, but do not wait for each other: those of many
/// are found before the first of these moves anything.
template <bool kDamped>
[[gnu::always_inline]] inline void correctAll(const FourLater* fours, std::ptrdiff_t count,
                                              const double* lag, const double* start, double* x) {
  constexpr std::ptrdiff_t kAtOnce = 32;
  double factors[kAtOnce * kLanes];
  for (; count > 0; fours += kAtOnce, count -= kAtOnce) {
    const std::ptrdiff_t some = std::min(count, kAtOnce);
    for (std::ptrdiff_t k = 0; k < some; ++k) {
      lanesAt(factors + kLanes * k) = factorsOf<kDamped>(fours[k], lag + k * kLanes, start, x);
    }
    for (std::ptrdiff_t k = 0; k < some; ++k) apply(factors + kLanes * k, fours[k], x);
    if (kDamped) lag += kAtOnce * kLanes;
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
void correctElasticLater(const FourLater* four, const FourLater* end, const double* lag,
                         const double* start, double* x) {
  correctAll<false>(four, end - four, lag, start, x);
}

CLOTH_SIM_VECTOR_CLONES
void correctDampedLater(const FourLater* four, const FourLater* end, const double* lag,
                        const double* start, double* x) {
  correctAll<true>(four, end - four, lag, start, x);
}

}  // namespace

template <typename Visit>
void OverflowProjection::forSprings(const SpringSchedule& schedule, const Visit& visit) const {
  const LaterSpan* span = schedule.spans().data() + schedule.firstLater();
  for (std::size_t s = 0; s + 1 < begins_.size(); ++s, ++span) {
    std::size_t k = kLanes * begins_[s];
    schedule.visit(*span, [&](const SpringSchedule::Element& spring) { visit(spring, k++); });
  }
}

void OverflowProjection::setMasses(const SpringSchedule& schedule, const ScalarArray& inverseMass) {
  findBegins(schedule);
  const std::vector<std::int32_t> places = listParticles(schedule, inverseMass);
  fours_.resize(begins_.back());
  lag_.assign(schedule.parameters.damped() ? kLanes * fours_.size() : 0, 0.0);
  forSprings(schedule, [&](const SpringSchedule::Element& spring, std::size_t k) {
    FourLater& four = fours_[k / kLanes];
    const std::size_t lane = k % kLanes;
    if (lane == 0) four = doingNothing(places[spring.a], places[spring.b]);
    four.a[lane] = places[spring.a];
    four.b[lane] = places[spring.b];
    four.rest[lane] = spring.parameters.restLength;
  });
}

void OverflowProjection::findBegins(const SpringSchedule& schedule) {
  begins_ = {0};
  for (std::size_t s = schedule.firstLater(); s < schedule.spans().size(); ++s) {
    begins_.push_back(begins_.back() + (schedule.spans()[s].count + kLanes - 1) / kLanes);
  }
}

/// By slot where the numbers of a particle begin, if it is one of theirs.
std::vector<std::int32_t> OverflowProjection::listParticles(const SpringSchedule& schedule,
                                                            const ScalarArray& inverseMass) {
  const std::size_t slots = inverseMass.size();
  std::vector<std::int32_t> places(slots, kNone);
  forSprings(schedule, [&](const SpringSchedule::Element& spring, std::size_t /*k*/) {
    places[spring.a] = places[spring.b] = 0;
  });
  slots_.clear();
  for (std::size_t slot = 0; slot < slots; ++slot) {
    if (places[slot] == kNone) continue;
    places[slot] = static_cast<std::int32_t>(kNumbers * slots_.size());
    slots_.push_back(static_cast<std::int32_t>(slot));
  }
  x_.assign(kNumbers * slots_.size(), 0.0);
  for (std::size_t k = 0; k < slots_.size(); ++k) x_[kNumbers * k + kMass] = inverseMass[slots_[k]];
  start_.assign(schedule.parameters.damped() ? x_.size() : 0, 0.0);
  return places;
}

/// Each of these springs has a parameters of its own; they follow each other as the springs do.
void OverflowProjection::setStep(const SpringSchedule& schedule, const Compliances& compliances) {
  if (slots_.empty()) return;
  auto parameters =
      static_cast<std::size_t>(schedule.spans()[schedule.firstLater()].firstParameters);
  forSprings(schedule, [&](const SpringSchedule::Element& /*spring*/, std::size_t k) {
    FourLater& four = fours_[k / kLanes];
    const std::size_t lane = k % kLanes;
    const double w = x_[four.a[lane] + kMass] + x_[four.b[lane] + kMass];
    const double lag = lag_.empty() ? 0.0 : compliances.lag[parameters];
    four.give[lane] = giveOf(w, compliances.alpha[parameters], lag);
    if (!lag_.empty()) lag_[k] = lag;
    ++parameters;
  });
}

void OverflowProjection::correct(const SpringSchedule& schedule, Particles& particles) {
  if (slots_.empty()) return;
  gather(particles);
  const auto correctFours = lag_.empty() ? correctElasticLater : correctDampedLater;
  const LaterSpan* const first = schedule.spans().data() + schedule.firstLater();
  schedule.sweepLater([&](const LaterSpan* span, const LaterSpan* end) {
    const std::size_t begin = begins_[span - first];
    correctFours(fours_.data() + begin, fours_.data() + begins_[end - first],
                 lag_.empty() ? nullptr : lag_.data() + kLanes * begin, start_.data(), x_.data());
  });
  scatter(particles);
}

void OverflowProjection::gather(const Particles& p) {
  const auto copy = [this](const VectorArray& from, ScalarArray& to) {
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

void OverflowProjection::scatter(Particles& p) const {
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
