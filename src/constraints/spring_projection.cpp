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

/// Whether two contiguous spans have the same weights, for any length of the substep.
bool haveSameWeights(const Span& s, const Span& t, const ScalarArray& inverseMass) {
  if (s.firstParameters != t.firstParameters || s.count != t.count) return false;
  const double* const w = inverseMass.data();
  return std::equal(w + s.ends.a, w + s.ends.a + s.count, w + t.ends.a) &&
         std::equal(w + s.ends.b, w + s.ends.b + s.count, w + t.ends.b);
}

}  // namespace

void SpringProjection::setMasses(const SpringSchedule& schedule, const ScalarArray& inverseMass) {
  const std::vector<Span>& spans = schedule.spans();
  keys_.clear();
  for (std::size_t s = 0; s < spans.size(); ++s) {
    const auto span = static_cast<std::int32_t>(s);
    if (spans[s].sharesParameters) keys_.push_back({hashOf(spans[s], inverseMass), span});
  }
  std::sort(keys_.begin(), keys_.end(), [](const Key& a, const Key& b) {
    return a.hash != b.hash ? a.hash < b.hash : a.span < b.span;
  });
  // Spans of one hash stand together; the first of them owns the blocks.
  firstBlock_.assign(spans.size(), kNone);
  std::vector<std::int32_t>& ownerOf = firstBlock_;
  for (std::size_t k = 0, first = 0; k < keys_.size(); ++k) {
    if (keys_[k].hash != keys_[first].hash) first = k;
    const auto owner = static_cast<std::size_t>(keys_[first].span);
    const auto span = static_cast<std::size_t>(keys_[k].span);
    const bool isShared = k != first && haveSameWeights(spans[owner], spans[span], inverseMass);
    if (isShared) ownerOf[span] = keys_[first].span;
  }
  owners_.clear();
  std::int32_t blocks = 0;
  for (std::size_t s = 0; s < spans.size(); ++s) {
    if (ownerOf[s] != kNone) {
      firstBlock_[s] = firstBlock_[static_cast<std::size_t>(ownerOf[s])];
      continue;
    }
    owners_.push_back(static_cast<std::int32_t>(s));
    firstBlock_[s] = blocks;
    blocks += blockCount(spans[s]);
  }
  blocks_.assign(static_cast<std::size_t>(blocks), {});
  gamma_.assign(schedule.parameters.damped() ? kLanes * blocks_.size() : 0, 0.0);
}

void SpringProjection::setStep(const SpringSchedule& schedule, const ScalarArray& inverseMass,
                               double h) {
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
    const WeightBlock* weights;
    const double* gamma;
    double *x, *y, *z;
    const double *startX, *startY, *startZ;
    Particles* particles;
  };
  /// A 3-vector for each of four springs.
  struct Vectors {
    Lanes x, y, z;
  };
  /// Four particles from a slot on.
  struct Contiguous {
    std::int32_t first;

    [[gnu::always_inline]] Lanes load(const double* p) const { return lanesAt(p + first); }
    [[gnu::always_inline]] void store(const Lanes& of, double* p) const { lanesAt(p + first) = of; }
  };
  /// Four particles anywhere.
  struct Gathered {
    const std::int32_t* slots;

    [[gnu::always_inline]] Lanes load(const double* p) const { return gather(p, slots); }
    [[gnu::always_inline]] void store(const Lanes& of, double* p) const { scatter(of, p, slots); }
  };

  [[gnu::always_inline]] static Vectors difference(const Vectors& b, const Vectors& a) {
    return {b.x - a.x, b.y - a.y, b.z - a.z};
  }
  [[gnu::always_inline]] static Lanes dot(const Vectors& a, const Vectors& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }

  /// Projects four springs that share no particle.
  template <bool kDamped, typename Index>
  [[gnu::always_inline]] static void projectFour(const Arrays& m, const Index& a, const Index& b,
                                                 const double* restLength, std::ptrdiff_t block) {
    Vectors xa{a.load(m.x), a.load(m.y), a.load(m.z)};
    Vectors xb{b.load(m.x), b.load(m.y), b.load(m.z)};
    const Vectors d = difference(xb, xa);
    const Lanes squared = dot(d, d) + kTinySquare;
    const Lanes length = sqrt(squared);
    Lanes error = length - lanesAt(restLength);
    if constexpr (kDamped) {
      const Vectors start = difference({b.load(m.startX), b.load(m.startY), b.load(m.startZ)},
                                       {a.load(m.startX), a.load(m.startY), a.load(m.startZ)});
      error += lanesAt(m.gamma + kLanes * block) * ((squared - dot(d, start)) / length);
    }
    const Lanes lambda = error / length;
    const Lanes moveA = lanesAt(m.weights[block].a) * lambda;
    const Lanes moveB = lanesAt(m.weights[block].b) * lambda;
    a.store(xa.x + moveA * d.x, m.x);
    a.store(xa.y + moveA * d.y, m.y);
    a.store(xa.z + moveA * d.z, m.z);
    b.store(xb.x - moveB * d.x, m.x);
    b.store(xb.y - moveB * d.y, m.y);
    b.store(xb.z - moveB * d.z, m.z);
  }

  /// Projects the SIMD blocks of a span; `ends(k)` gives the ends of springs k to k + 3.
  template <bool kDamped, typename Ends>
  [[gnu::always_inline]] static void projectBlocks(const Arrays& m, const Span& span,
                                                   std::ptrdiff_t block, const Ends& ends) {
    const double* const rest = m.restLength + span.firstParameters;
    const auto projectAt = [&](std::int32_t k) __attribute__((always_inline)) {
      const auto [a, b] = ends(k);
      projectFour<kDamped>(m, a, b, rest + k, block++);
    };
    if (span.count % kLanes != 0) projectAt(span.count - kLanes);
    for (std::int32_t k = 0; k + kLanes <= span.count; k += kLanes) projectAt(k);
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
      const Span& span = m.spans[s];
      const std::ptrdiff_t block = m.firstBlock[s];
      if (span.isContiguous) {
        projectBlocks<kDamped>(
            m, span, block, [&](std::int32_t k) __attribute__((always_inline)) {
              return std::pair(Contiguous{span.ends.a + k}, Contiguous{span.ends.b + k});
            });
      } else if (span.count >= kLanes) {
        projectBlocks<kDamped>(
            m, span, block, [&](std::int32_t k) __attribute__((always_inline)) {
              const std::int32_t at = span.firstEnd + k;
              return std::pair(Gathered{m.endA + at}, Gathered{m.endB + at});
            });
      } else {
        projectFew<kDamped>(m, span, block);
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

void SpringProjection::project(const SpringSchedule& schedule, Particles& p) const {
  const Span* const spans = schedule.spans().data();
  const Kernel::Arrays arrays{spans,
                              schedule.endA.data(),
                              schedule.endB.data(),
                              schedule.parameters.restLength().data(),
                              firstBlock_.data(),
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
  schedule.sweepSpans([&](const Span* begin, const Span* end) {
    projectSpans(arrays, begin - spans, end - spans);
  });
}

}  // namespace cloth_sim
