#include "spring_projection.h"

#include <algorithm>
#include <cstring>

#include "reference_projection.h"
#include "support/simd.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

using Span = SpringSchedule::Span;

std::int32_t blockCount(const Span& span) { return (span.count + kLanes - 1) / kLanes; }

/// The first spring of the n-th SIMD block of a span: see SpringProjection. Negative in gathered
/// spans of fewer than four springs.
std::int32_t firstSpring(const Span& span, std::int32_t n) {
  const std::int32_t rest = span.count % kLanes;
  if (rest == 0) return kLanes * n;
  return n == 0 ? span.count - kLanes : kLanes * (n - 1);
}

/// The least lane of a block whose spring that block projects.
std::int32_t firstLane(const Span& span, std::int32_t n) {
  const std::int32_t rest = span.count % kLanes;
  return n == 0 && rest != 0 ? kLanes - rest : 0;
}

std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9e3779b97f4a7c15ULL;
  return hash ^ (hash >> 29U);
}

std::uint64_t bitsOf(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// A hash of the parameters and masses of a contiguous span.
std::uint64_t hashOf(const Span& span, const ScalarArray& inverseMass) {
  std::uint64_t hash = mixed(static_cast<std::uint64_t>(span.firstParameters),
                             static_cast<std::uint64_t>(span.count));
  for (std::int32_t k = 0; k < span.count; ++k) {
    hash = mixed(hash, bitsOf(inverseMass[span.ends.a + k]));
    hash = mixed(hash, bitsOf(inverseMass[span.ends.b + k]));
  }
  return hash;
}

/// Tells whether two contiguous spans have the same weights, for any length of the substep.
bool haveSameWeights(const Span& s, const Span& t, const ScalarArray& inverseMass) {
  if (s.firstParameters != t.firstParameters || s.count != t.count) return false;
  const double* const w = inverseMass.data();
  return std::equal(w + s.ends.a, w + s.ends.a + s.count, w + t.ends.a) &&
         std::equal(w + s.ends.b, w + s.ends.b + s.count, w + t.ends.b);
}

}  // namespace

void SpringProjection::setMasses(const SpringSchedule& schedule, const ScalarArray& inverseMass) {
  overflow_.setMasses(schedule, inverseMass);
  findOwners(schedule, inverseMass);
  const std::vector<Span>& spans = schedule.spans();
  owners_.clear();
  std::int32_t blocks = 0;
  for (std::size_t s = 0; s < firstBlock_.size(); ++s) {
    if (firstBlock_[s] != kNone) {
      firstBlock_[s] = firstBlock_[static_cast<std::size_t>(firstBlock_[s])];
      continue;
    }
    owners_.push_back(static_cast<std::int32_t>(s));
    firstBlock_[s] = blocks;
    blocks += blockCount(spans[s]);
  }
  symmetric_.resize(firstBlock_.size());
  for (std::size_t k = 0; k < symmetric_.size(); ++k) {
    symmetric_[k] = symmetricBlocks(schedule, k, inverseMass);
  }
  blocks_.assign(static_cast<std::size_t>(blocks), {});
  gamma_.assign(schedule.parameters.damped() ? kLanes * blocks_.size() : 0, 0.0);
}

/// Sets `firstBlock_` to the span whose blocks a span shares, or to kNone if it has its own.
void SpringProjection::findOwners(const SpringSchedule& schedule, const ScalarArray& inverseMass) {
  const std::vector<Span>& spans = schedule.spans();
  const std::size_t count = schedule.firstOverflow();
  keys_.clear();
  for (std::size_t s = 0; s < count; ++s) {
    const auto span = static_cast<std::int32_t>(s);
    if (spans[s].sharesParameters) keys_.push_back({hashOf(spans[s], inverseMass), span});
  }
  std::sort(keys_.begin(), keys_.end(), [](const Key& a, const Key& b) {
    return a.hash != b.hash ? a.hash < b.hash : a.span < b.span;
  });
  // Spans of one hash stand together; the first of them owns the blocks.
  firstBlock_.assign(count, kNone);
  for (std::size_t k = 0, first = 0; k < keys_.size(); ++k) {
    if (keys_[k].hash != keys_[first].hash) first = k;
    const auto owner = static_cast<std::size_t>(keys_[first].span);
    const auto span = static_cast<std::size_t>(keys_[k].span);
    const bool isShared = k != first && haveSameWeights(spans[owner], spans[span], inverseMass);
    if (isShared) firstBlock_[span] = keys_[first].span;
  }
}

/// The longest sequence of full blocks with equal masses at both ends; none in gathered spans.
SpringProjection::BlockRange SpringProjection::symmetricBlocks(const SpringSchedule& schedule,
                                                               std::size_t s,
                                                               const ScalarArray& inverseMass) {
  const Span& span = schedule.spans()[s];
  BlockRange longest;
  if (!span.isContiguous) return longest;
  const double* const a = inverseMass.data() + span.ends.a;
  const double* const b = inverseMass.data() + span.ends.b;
  std::int32_t from = 0;
  for (std::int32_t block = 0; block < span.count / kLanes; ++block) {
    const std::int32_t k = kLanes * block;
    if (!std::equal(a + k, a + k + kLanes, b + k)) from = block + 1;
    if (block + 1 - from > longest.end - longest.from) longest = {from, block + 1};
  }
  return longest;
}

void SpringProjection::setStep(const SpringSchedule& schedule, const ScalarArray& inverseMass,
                               double h) {
  overflow_.setStep(schedule, inverseMass, h);
  for (const std::int32_t owner : owners_) {
    const Span& span = schedule.spans()[static_cast<std::size_t>(owner)];
    for (std::int32_t n = 0; n < blockCount(span); ++n) {
      const auto block = static_cast<std::size_t>(firstBlock_[static_cast<std::size_t>(owner)] + n);
      for (std::int32_t lane = firstLane(span, n); lane < kLanes; ++lane) {
        const std::int32_t k = firstSpring(span, n) + lane;
        const SpringEnds ends = schedule.endsOf(span, k);
        const ProjectionWeights weights =
            projectionWeights(schedule.parameters[span.firstParameters + k], inverseMass[ends.a],
                              inverseMass[ends.b], h);
        blocks_[block].a[lane] = weights.a;
        blocks_[block].b[lane] = weights.b;
        if (!gamma_.empty()) gamma_[kLanes * block + lane] = weights.gamma;
      }
    }
  }
}

/// The vectorised projection: operation by operation that of reference_projection.h.
struct SpringProjection::Kernel {
  /// Arrays that it reads and writes; passed by value, so that they stay in registers.
  struct Arrays {
    const Span* spans;
    const std::int32_t *endA, *endB;
    const double* restLength;
    const std::int32_t* firstBlock;
    const BlockRange* symmetric;
    const WeightBlock* weights;
    const double* gamma;
    double *x, *y, *z;
    double *startX, *startY, *startZ;  ///< read only
    Particles* particles;
  };
  /// A 3-vector for each of four springs.
  struct Vectors {
    Lanes x, y, z;
  };
  /// Three coordinates of consecutive particles.
  struct Contiguous {
    double *x, *y, *z;
    std::ptrdiff_t at;  ///< of the first of four

    [[gnu::always_inline]] Vectors load() const {
      return {lanesAt(x + at), lanesAt(y + at), lanesAt(z + at)};
    }
    [[gnu::always_inline]] void store(const Vectors& of) const {
      lanesAt(x + at) = of.x;
      lanesAt(y + at) = of.y;
      lanesAt(z + at) = of.z;
    }
  };
  /// Three coordinates of particles anywhere.
  struct Gathered {
    double *x, *y, *z;
    const std::int32_t* at;  ///< slots of four

    [[gnu::always_inline]] Vectors load() const {
      return {gather(x, at), gather(y, at), gather(z, at)};
    }
    [[gnu::always_inline]] void store(const Vectors& of) const {
      scatter(of.x, x, at);
      scatter(of.y, y, at);
      scatter(of.z, z, at);
    }
  };
  [[gnu::always_inline]] static Vectors difference(const Vectors& b, const Vectors& a) {
    return {b.x - a.x, b.y - a.y, b.z - a.z};
  }
  [[gnu::always_inline]] static Vectors scaled(const Lanes& s, const Vectors& a) {
    return {s * a.x, s * a.y, s * a.z};
  }
  [[gnu::always_inline]] static Lanes dot(const Vectors& a, const Vectors& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }

  /// Projects four springs that share no particle.
  /// \param a, b            their ends.
  /// \param startA, startB  the same at the start of the substep; read only if `kDamped`.
  /// \tparam kSymmetric      whether both ends of each spring have the same weight.
  template <bool kDamped, bool kSymmetric, typename Index>
  [[gnu::always_inline]] static void projectFour(const Index& a, const Index& b,
                                                 const Index& startA, const Index& startB,
                                                 const double* restLength,
                                                 const WeightBlock* weights, const double* gamma) {
    const Vectors xa = a.load();
    const Vectors xb = b.load();
    const Vectors d = difference(xb, xa);
    const Lanes squared = dot(d, d) + kTinySquare;
    const Lanes length = sqrt(squared);
    Lanes error = length - lanesAt(restLength);
    if constexpr (kDamped) {
      const Vectors start = difference(startB.load(), startA.load());
      error += lanesAt(gamma) * ((squared - dot(d, start)) / length);
    }
    const Lanes lambda = error / length;
    const Vectors moveA = scaled(lanesAt(weights->a) * lambda, d);
    const Vectors moveB = kSymmetric ? moveA : scaled(lanesAt(weights->b) * lambda, d);
    a.store({xa.x + moveA.x, xa.y + moveA.y, xa.z + moveA.z});
    b.store({xb.x - moveB.x, xb.y - moveB.y, xb.z - moveB.z});
  }

  /// Projects the SIMD blocks of a span. `a(k, x, y, z)` and `b(k, x, y, z)` give the ends of
  /// springs k to k + 3.
  template <bool kDamped, typename IndexA, typename IndexB>
  [[gnu::always_inline]] static void projectBlocks(const Arrays& m, std::ptrdiff_t s,
                                                   const Span& span, const IndexA& a,
                                                   const IndexB& b) {
    const double* const rest = m.restLength + span.firstParameters;
    const WeightBlock* weights = m.weights + m.firstBlock[s];
    const double* gamma = kDamped ? m.gamma + kLanes * m.firstBlock[s] : nullptr;
    const auto project = [&](std::ptrdiff_t k, std::ptrdiff_t n, auto isSymmetric)
        __attribute__((always_inline)) {
      projectFour<kDamped, decltype(isSymmetric)::value>(
          a(k, m.x, m.y, m.z), b(k, m.x, m.y, m.z), a(k, m.startX, m.startY, m.startZ),
          b(k, m.startX, m.startY, m.startZ), rest + k, weights + n,
          kDamped ? gamma + kLanes * n : nullptr);
    };
    if (span.count % kLanes != 0) {
      project(span.count - kLanes, 0, std::false_type());
      ++weights;
      if (kDamped) gamma += kLanes;
    }
    const std::ptrdiff_t blocks = span.count / kLanes;
    const BlockRange symmetric = m.symmetric[s];
    for (std::ptrdiff_t n = 0; n < symmetric.from; ++n) project(kLanes * n, n, std::false_type());
    for (std::ptrdiff_t n = symmetric.from; n < symmetric.end; ++n) {
      project(kLanes * n, n, std::true_type());
    }
    for (std::ptrdiff_t n = symmetric.end; n < blocks; ++n) {
      project(kLanes * n, n, std::false_type());
    }
  }

  [[gnu::always_inline]] static auto contiguous(std::ptrdiff_t first) {
    return [first](std::ptrdiff_t k, double* x, double* y, double* z)
        __attribute__((always_inline)) {
      return Contiguous{x + first, y + first, z + first, k};
    };
  }
  [[gnu::always_inline]] static auto gathered(const std::int32_t* slots) {
    return [slots](std::ptrdiff_t k, double* x, double* y, double* z)
        __attribute__((always_inline)) {
      return Gathered{x, y, z, slots + k};
    };
  }

  /// Projects the springs of a gathered span of fewer than four, one by one.
  template <bool kDamped>
  static void projectFew(const Arrays& m, const Span& span, std::ptrdiff_t block) {
    for (std::int32_t k = 0; k < span.count; ++k) {
      const std::ptrdiff_t lane = firstLane(span, 0) + k;
      const WeightBlock& weights = m.weights[block];
      projectSpring<kDamped>(
          static_cast<std::size_t>(m.endA[span.firstEnd + k]),
          static_cast<std::size_t>(m.endB[span.firstEnd + k]),
          m.restLength[span.firstParameters + k],
          {weights.a[lane], weights.b[lane], kDamped ? m.gamma[kLanes * block + lane] : 0.0},
          *m.particles);
    }
  }

  template <bool kDamped>
  [[gnu::always_inline]] static void projectSpans(const Arrays& m, std::ptrdiff_t begin,
                                                  std::ptrdiff_t end) {
    for (std::ptrdiff_t s = begin; s < end; ++s) {
      const Span span = m.spans[s];
      if (span.isContiguous) {
        projectBlocks<kDamped>(m, s, span, contiguous(span.ends.a), contiguous(span.ends.b));
      } else if (span.count >= kLanes) {
        projectBlocks<kDamped>(m, s, span, gathered(m.endA + span.firstEnd),
                               gathered(m.endB + span.firstEnd));
      } else {
        projectFew<kDamped>(m, span, m.firstBlock[s]);
      }
    }
  }

  CLOTH_SIM_VECTOR_CLONES
  static void projectElastic(const Arrays& arrays, std::ptrdiff_t begin, std::ptrdiff_t end) {
    const Arrays m = arrays;
    projectSpans<false>(m, begin, end);
  }
  CLOTH_SIM_VECTOR_CLONES
  static void projectDamped(const Arrays& arrays, std::ptrdiff_t begin, std::ptrdiff_t end) {
    const Arrays m = arrays;
    projectSpans<true>(m, begin, end);
  }
};

void SpringProjection::project(const SpringSchedule& schedule, Particles& p) {
  const Span* const spans = schedule.spans().data();
  const Kernel::Arrays arrays{spans,
                              schedule.endA.data(),
                              schedule.endB.data(),
                              schedule.parameters.restLength().data(),
                              firstBlock_.data(),
                              symmetric_.data(),
                              blocks_.data(),
                              gamma_.data(),
                              p.x.x.data(),
                              p.x.y.data(),
                              p.x.z.data(),
                              p.start.x.data(),
                              p.start.y.data(),
                              p.start.z.data(),
                              &p};
  const auto projectSpans =
      schedule.parameters.damped() ? Kernel::projectDamped : Kernel::projectElastic;
  schedule.sweepOriginals([&](const Span* begin, const Span* end) {
    projectSpans(arrays, begin - spans, end - spans);
  });
  overflow_.project(schedule, p);
}

}  // namespace cloth_sim
