#include "overflow_projection.h"

#include "reference_projection.h"
#include "support/simd.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

/// Numbers in the copy of a particle.
constexpr std::int32_t kStride = kLanes;
/// Fewer copies are not worth a second thread.
constexpr std::int32_t kGrainCopies = 4096;

}  // namespace

void OverflowProjection::setMasses(const SpringSchedule& schedule, const ScalarArray& inverseMass) {
  findParticles(schedule, inverseMass.size());
  const std::vector<SpringSchedule::Span>& spans = schedule.spans();
  firstBlock_.assign(1, 0);
  for (std::size_t s = schedule.firstOverflow(); s < spans.size(); ++s) {
    firstBlock_.push_back(firstBlock_.back() + (spans[s].count + kLanes - 1) / kLanes);
  }
  blocks_.assign(static_cast<std::size_t>(firstBlock_.back()), {});
  gamma_.assign(schedule.parameters.damped() ? kLanes * blocks_.size() : 0, 0.0);
  forEach(schedule, [&](const SpringSchedule::Element& spring, std::size_t k, std::int32_t lane) {
    Block& block = blocks_[k];
    // Lanes that stay without a spring get the ends of the first one.
    for (std::int32_t other = lane; other < (lane == 0 ? kLanes : lane + 1); ++other) {
      block.a[other] = places_[spring.a];
      block.b[other] = places_[spring.b];
    }
    block.restLength[lane] = spring.parameters.restLength;
  });
}

void OverflowProjection::findParticles(const SpringSchedule& schedule, std::size_t slots) {
  places_.assign(slots, kNone);
  for (std::size_t s = schedule.firstOverflow(); s < schedule.spans().size(); ++s) {
    schedule.visit(schedule.spans()[s], [this](const SpringSchedule::Element& spring) {
      places_[spring.a] = places_[spring.b] = 0;
    });
  }
  slots_.clear();
  for (std::size_t slot = 0; slot < slots; ++slot) {
    if (places_[slot] == kNone) continue;
    places_[slot] = kStride * static_cast<std::int32_t>(slots_.size());
    slots_.push_back(static_cast<std::int32_t>(slot));
  }
  x_.assign(kStride * slots_.size(), 0.0);
  start_.assign(schedule.parameters.damped() ? x_.size() : 0, 0.0);
}

template <typename Visit>
void OverflowProjection::forEach(const SpringSchedule& schedule, const Visit& visit) const {
  const std::size_t first = schedule.firstOverflow();
  for (std::size_t s = first; s < schedule.spans().size(); ++s) {
    const SpringSchedule::Span& span = schedule.spans()[s];
    schedule.visit(span, [&](const SpringSchedule::Element& spring) {
      const std::int32_t k = spring.position - span.first;
      visit(spring, static_cast<std::size_t>(firstBlock_[s - first] + k / kLanes), k % kLanes);
    });
  }
}

void OverflowProjection::setStep(const SpringSchedule& schedule, const ScalarArray& inverseMass,
                                 double h) {
  forEach(schedule, [&](const SpringSchedule::Element& spring, std::size_t k, std::int32_t lane) {
    const ProjectionWeights weights =
        projectionWeights(spring.parameters, inverseMass[spring.a], inverseMass[spring.b], h);
    blocks_[k].weightA[lane] = weights.a;
    blocks_[k].weightB[lane] = weights.b;
    if (!gamma_.empty()) gamma_[kLanes * k + static_cast<std::size_t>(lane)] = weights.gamma;
  });
}

/// The vectorised projection: operation by operation that of reference_projection.h.
struct OverflowProjection::Kernel {
  /// A 3-vector for each of four springs.
  struct Vectors {
    Lanes x, y, z;
  };

  /// b - a of four springs.
  [[gnu::always_inline]] static Vectors differences(const Block& springs, const double* x) {
    Lanes d[kLanes];
    for (std::int32_t k = 0; k < kLanes; ++k) {
      d[k] = lanesAt(x + springs.b[k]) - lanesAt(x + springs.a[k]);
    }
    transpose(d[0], d[1], d[2], d[3]);
    return {d[0], d[1], d[2]};
  }
  [[gnu::always_inline]] static Lanes dot(const Vectors& a, const Vectors& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }

  template <bool kDamped>
  [[gnu::always_inline]] static void projectFour(const Block& springs, const double* gamma,
                                                 const double* start, double* x) {
    const Vectors d = differences(springs, x);
    const Lanes squared = dot(d, d) + kTinySquare;
    const Lanes length = sqrt(squared);
    Lanes error = length - lanesAt(springs.restLength);
    if constexpr (kDamped) {
      error += lanesAt(gamma) * ((squared - dot(d, differences(springs, start))) / length);
    }
    const Lanes lambda = error / length;
    const Lanes factorA = lanesAt(springs.weightA) * lambda;
    const Lanes factorB = lanesAt(springs.weightB) * lambda;
    for (std::int32_t k = 0; k < kLanes; ++k) {
      Lanes& a = lanesAt(x + springs.a[k]);
      Lanes& b = lanesAt(x + springs.b[k]);
      const Lanes along = b - a;
      a += factorA[k] * along;
      b -= factorB[k] * along;
    }
  }

  CLOTH_SIM_VECTOR_CLONES
  static void projectElastic(const Block* springs, const Block* end, const double* /*gamma*/,
                             const double* /*start*/, double* x) {
    for (; springs != end; ++springs) projectFour<false>(*springs, nullptr, nullptr, x);
  }
  CLOTH_SIM_VECTOR_CLONES
  static void projectDamped(const Block* springs, const Block* end, const double* gamma,
                            const double* start, double* x) {
    for (; springs != end; ++springs, gamma += kLanes) projectFour<true>(*springs, gamma, start, x);
  }
};

void OverflowProjection::project(const SpringSchedule& schedule, Particles& particles) {
  if (slots_.empty()) return;
  load(particles.x, x_);
  if (!start_.empty()) load(particles.start, start_);
  const auto projectBlocks = start_.empty() ? Kernel::projectElastic : Kernel::projectDamped;
  const SpringSchedule::Span* const first = schedule.spans().data() + schedule.firstOverflow();
  schedule.sweepOverflow([&](const SpringSchedule::Span* span, const SpringSchedule::Span* end) {
    const std::int32_t begin = firstBlock_[span - first];
    projectBlocks(blocks_.data() + begin, blocks_.data() + firstBlock_[end - first],
                  gamma_.empty() ? nullptr : gamma_.data() + kLanes * begin, start_.data(),
                  x_.data());
  });
  store(particles.x);
}

void OverflowProjection::load(const VectorArray& from, ScalarArray& copies) const {
  const auto copy = [&](std::int32_t first, std::int32_t last) {
    for (std::int32_t k = first; k < last; ++k) {
      double* const copied = copies.data() + kStride * k;
      copied[0] = from.x[slots_[k]];
      copied[1] = from.y[slots_[k]];
      copied[2] = from.z[slots_[k]];
    }
  };
  parallelFor(static_cast<std::int32_t>(slots_.size()), kGrainCopies, copy);
}

void OverflowProjection::store(VectorArray& to) const {
  const auto copy = [&](std::int32_t first, std::int32_t last) {
    for (std::int32_t k = first; k < last; ++k) {
      to.set(static_cast<std::size_t>(slots_[k]), Vec3(x_.data() + kStride * k));
    }
  };
  parallelFor(static_cast<std::int32_t>(slots_.size()), kGrainCopies, copy);
}

}  // namespace cloth_sim
