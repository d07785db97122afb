#include "line_projection.h"

#include <algorithm>
#include <map>
#include <string>

#include "linalg/vector_operations.h"
#include "spring_parameters.h"
#include "support/vector_clones.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Compliance of a place without a spring [1/kg]: it pulls nothing.
constexpr double kNoSpring = 1e30;
/// Springs that are worth a thread of their own.
constexpr std::int32_t kGrain = 2048;

}  // namespace

void LineProjection::prepare(const SpringLines& lines, const SpringNetwork& springs, double h) {
  parameters_.clear();
  gamma_.clear();
  firstParameters_.clear();
  bool isDamped = false;
  std::map<std::string, std::int32_t> known;  // contents of a batch -> its first parameters
  for (const SpringLines::Batch& batch : lines.batches()) {
    const auto first = static_cast<std::int32_t>(parameters_.size());
    for (std::int32_t s = 0; s < batch.steps; ++s) {
      Parameters four;
      for (std::int32_t lane = 0; lane < kLanes; ++lane) {
        const std::int32_t slot = lines.springs()[batch.firstStep + s][lane];
        const Spring spring = slot == kNone ? Spring() : springs[slot];
        const bool pulls = spring.stiffness > 0.0;
        const double gamma = pulls ? spring.damping / (spring.stiffness * h) : 0.0;
        four.restLength[lane] = spring.restLength;
        four.compliance[lane] =
            pulls ? 1.0 / (spring.stiffness * h * h * (1.0 + gamma)) : kNoSpring;
        gamma_.push_back(gamma);
        isDamped |= gamma > 0.0;
      }
      parameters_.push_back(four);
    }
    if (isDamped) {  // gamma_ goes by the same index
      firstParameters_.push_back(first);
      continue;
    }
    const std::string content(reinterpret_cast<const char*>(parameters_.data() + first),
                              sizeof(Parameters) * static_cast<std::size_t>(batch.steps));
    const auto [entry, isNew] = known.emplace(content, first);
    firstParameters_.push_back(entry->second);
    if (isNew) continue;
    parameters_.resize(static_cast<std::size_t>(first));
    gamma_.resize(static_cast<std::size_t>(kLanes * first));
  }
  if (!isDamped) gamma_.clear();
  offsets_.resize(lines.slots().size());
  for (std::size_t k = 0; k < offsets_.size(); ++k) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      offsets_[k][lane] =
          placeOf(lines.slots()[k][lane]) * static_cast<std::uint32_t>(sizeof(Body));
    }
  }
}

/// The direct solves of four lines at once. The unknowns are nu = mu / l, and each row of the
/// system is multiplied by l: then its entries are products of d, the vectors between the ends of
/// springs, instead of unit vectors, and no spring needs a division besides that of its pivot.
struct LineProjection::Kernel {
  using Slots = SpringLines::Slots;
  using Offsets = std::array<std::uint32_t, kLanes>;
  using Batch = SpringLines::Batch;

  /// Copied coordinate by coordinate: GCC copies the whole in halves of vectors, which then wait
  /// for each other.
  struct Vectors {
    Lanes x, y, z;
    Vectors() = default;
    [[gnu::always_inline]] Vectors(const Lanes& ofX, const Lanes& ofY, const Lanes& ofZ)
        : x(ofX), y(ofY), z(ofZ) {}
    [[gnu::always_inline]] Vectors(const Vectors& other) : x(other.x), y(other.y), z(other.z) {}
    [[gnu::always_inline]] Vectors& operator=(const Vectors& other) {
      x = other.x;
      y = other.y;
      z = other.z;
      return *this;
    }
  };
  /// A row of the factorised system, L D L^T: kept from the pass forwards for the one back.
  struct Row {
    Vectors d;        ///< from begin to end of each spring [m]
    Vectors end;      ///< particles at the end of the springs [m]
    Lanes w;          ///< their inverse masses
    Lanes off;        ///< entry beside the diagonal, towards the step before
    Lanes inverse;    ///< of the pivot
    Lanes rightSide;  ///< after elimination
  };
  /// Arrays that it reads and writes; passed by value, so that they stay in registers.
  struct Arrays {
    const Batch* batches;
    const Slots* slots;
    const Parameters* parameters;
    const double* gamma;
    const std::int32_t* firstParameters;
    const Offsets* offsets;
    char* bodies;
    const double *startX, *startY, *startZ;
    double *pullX, *pullY, *pullZ;
    double* moved;
  };

  [[gnu::always_inline]] static Lanes dot(const Vectors& a, const Vectors& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }
  /// The particle at an offset, as a vector.
  [[gnu::always_inline]] static Lanes& body(const Arrays& m, std::uint32_t offset) {
    return *reinterpret_cast<Lanes*>(m.bodies + offset);
  }
  /// Loads four particles.
  [[gnu::always_inline]] static void load(const Arrays& m, const Offsets& at, Vectors& x,
                                          Lanes& w) {
    x.x = body(m, at[0]);
    x.y = body(m, at[1]);
    x.z = body(m, at[2]);
    w = body(m, at[3]);
    transpose(x.x, x.y, x.z, w);
  }
  /// Stores four particles. Lanes without a line name the same particles as the lane before, which
  /// is written last.
  [[gnu::always_inline]] static void store(const Arrays& m, const Offsets& at, const Vectors& x,
                                           const Lanes& w) {
    Lanes a = x.x, b = x.y, c = x.z, d = w;
    transpose(a, b, c, d);
    body(m, at[3]) = d;
    body(m, at[2]) = c;
    body(m, at[1]) = b;
    body(m, at[0]) = a;
  }
  [[gnu::always_inline]] static Vectors loadStart(const Arrays& m, const Slots& at) {
    return {gather(m.startX, at.data()), gather(m.startY, at.data()), gather(m.startZ, at.data())};
  }

  /// State of the pass forwards.
  struct Forward {
    Vectors x;      ///< particle at the beginning of the next spring [m]
    Vectors start;  ///< the same at the start of the substep
    Lanes w;        ///< its inverse mass
    Vectors d;      ///< of the spring before, from its begin to its end
    Lanes inverse;  ///< of its pivot; zero at the first spring
    Lanes rightSide;
  };

  /// Eliminates a step whose springs end at the particles `end`.
  template <bool kDamped>
  [[gnu::always_inline]] static void eliminate(const Arrays& m, const Slots& end,
                                               const Offsets& endOffsets, const Parameters& four,
                                               const double* gamma, Forward& f, Row& row) {
    Vectors xb;
    Lanes wb;
    load(m, endOffsets, xb, wb);
    const Vectors d{xb.x - f.x.x, xb.y - f.x.y, xb.z - f.x.z};
    const Lanes squared = dot(d, d) + kTinySquare;
    Lanes error = squared - lanesAt(four.restLength) * sqrt(squared);
    if constexpr (kDamped) {
      const Vectors startB = loadStart(m, end);
      const Vectors start{startB.x - f.start.x, startB.y - f.start.y, startB.z - f.start.z};
      const Lanes g = lanesAt(gamma);
      error = (error + g * (squared - dot(d, start))) / (1.0 + g);
      f.start = startB;
    }
    const Lanes off = -f.w * dot(d, f.d);
    const Lanes factor = off * f.inverse;
    f.inverse = 1.0 / ((f.w + wb + lanesAt(four.compliance)) * squared - factor * off);
    f.rightSide = error - factor * f.rightSide;
    f.x = xb;
    f.w = wb;
    f.d = d;
    row.d = d;
    row.end = xb;
    row.w = wb;
    row.off = off;
    row.inverse = f.inverse;
    row.rightSide = f.rightSide;
  }

  /// Moves particles by the pull of the springs on both sides.
  /// \param x  where they are.
  template <bool kMeasured>
  [[gnu::always_inline]] static void move(const Arrays& m, const Slots& at, const Offsets& offsets,
                                          const Vectors& x, const Lanes& w, const Vectors& pull) {
    const Vectors by{w * pull.x, w * pull.y, w * pull.z};
    store(m, offsets, {x.x + by.x, x.y + by.y, x.z + by.z}, w);
    if constexpr (kMeasured) addLengths(m, at, sqrt(dot(by, by)));
    if (w[0] * w[1] * w[2] * w[3] == 0.0) recordPull(m, at, w, pull);
  }

  [[gnu::always_inline]] static void addLengths(const Arrays& m, const Slots& at,
                                                const Lanes& lengths) {
    const Lanes sum = gather(m.moved, at.data()) + lengths;
    for (std::int32_t lane = kLanes; lane-- > 0;) m.moved[at[lane]] = sum[lane];
  }

  /// Adds what the springs do to held particles.
  static void recordPull(const Arrays& m, const Slots& slots, const Lanes& w, const Vectors& pull) {
    for (std::int32_t lane = 0; lane < kLanes; ++lane) {
      if (w[lane] != 0.0) continue;
      const std::int32_t slot = slots[lane];
      m.pullX[slot] += pull.x[lane];
      m.pullY[slot] += pull.y[lane];
      m.pullZ[slot] += pull.z[lane];
    }
  }

  /// Solves the four lines of a batch.
  template <bool kDamped, bool kMeasured>
  [[gnu::always_inline]] static void solve(const Arrays& m, std::ptrdiff_t index, Row* rows) {
    const Batch& batch = m.batches[index];
    const Slots* const slots = m.slots + batch.firstPlace;
    const Offsets* const offsets = m.offsets + batch.firstPlace;
    const Parameters* const parameters = m.parameters + m.firstParameters[index];
    const double* const gamma = m.gamma + (kDamped ? kLanes * m.firstParameters[index] : 0);
    const std::ptrdiff_t steps = batch.steps;
    const Lanes zero{};
    Vectors firstX;
    Lanes firstW;
    load(m, offsets[0], firstX, firstW);
    Forward f;
    f.x = firstX;
    f.w = firstW;
    f.d = Vectors(zero, zero, zero);
    f.inverse = zero;
    f.rightSide = zero;
    if constexpr (kDamped) f.start = loadStart(m, slots[0]);
    for (std::ptrdiff_t s = 0; s < steps; ++s) {
      eliminate<kDamped>(m, slots[s + 1], offsets[s + 1], parameters[s], gamma + kLanes * s, f,
                         rows[s]);
    }
    Vectors after(zero, zero, zero);  // pull of the springs beyond the particle, mu n
    Lanes offAfter = zero, nu = zero;
    for (std::ptrdiff_t s = steps; s-- > 0;) {
      const Row& row = rows[s];
      nu = (row.rightSide - offAfter * nu) * row.inverse;
      offAfter = row.off;
      const Vectors own{nu * row.d.x, nu * row.d.y, nu * row.d.z};
      move<kMeasured>(m, slots[s + 1], offsets[s + 1], row.end, row.w,
                      {after.x - own.x, after.y - own.y, after.z - own.z});
      after = own;
    }
    move<kMeasured>(m, slots[0], offsets[0], firstX, firstW, after);
  }

  template <bool kDamped, bool kMeasured>
  [[gnu::always_inline]] static void solveAll(const Arrays& arrays, std::ptrdiff_t begin,
                                              std::ptrdiff_t end, Row* rows) {
    const Arrays m = arrays;
    for (std::ptrdiff_t k = begin; k < end; ++k) solve<kDamped, kMeasured>(m, k, rows);
  }

  // Not templates: GCC makes no clones of those.
  CLOTH_SIM_VECTOR_CLONES
  static void solveElastic(const Arrays& arrays, std::ptrdiff_t begin, std::ptrdiff_t end,
                           Row* rows) {
    solveAll<false, false>(arrays, begin, end, rows);
  }
  CLOTH_SIM_VECTOR_CLONES
  static void solveElasticMeasured(const Arrays& arrays, std::ptrdiff_t begin, std::ptrdiff_t end,
                                   Row* rows) {
    solveAll<false, true>(arrays, begin, end, rows);
  }
  CLOTH_SIM_VECTOR_CLONES
  static void solveDamped(const Arrays& arrays, std::ptrdiff_t begin, std::ptrdiff_t end,
                          Row* rows) {
    solveAll<true, false>(arrays, begin, end, rows);
  }
  CLOTH_SIM_VECTOR_CLONES
  static void solveDampedMeasured(const Arrays& arrays, std::ptrdiff_t begin, std::ptrdiff_t end,
                                  Row* rows) {
    solveAll<true, true>(arrays, begin, end, rows);
  }
  template <bool kMeasured>
  static auto solver(bool isDamped) {
    if (kMeasured) return isDamped ? solveDampedMeasured : solveElasticMeasured;
    return isDamped ? solveDamped : solveElastic;
  }
};

template <bool kMeasured>
void LineProjection::run(const SpringLines& lines, const ScalarArray& inverseMass, Particles& p,
                         VectorArray& pull, double* moved) {
  loadBodies(inverseMass, p);
  const Kernel::Arrays arrays{lines.batches().data(),
                              lines.slots().data(),
                              parameters_.data(),
                              gamma_.data(),
                              firstParameters_.data(),
                              offsets_.data(),
                              reinterpret_cast<char*>(bodies_.data()),
                              p.start.x.data(),
                              p.start.y.data(),
                              p.start.z.data(),
                              pull.x.data(),
                              pull.y.data(),
                              pull.z.data(),
                              moved};
  const auto longest = static_cast<std::size_t>(lines.longest());
  for (const SpringLines::Colour& colour : lines.colours()) {
    const std::int32_t batches = colour.endBatch - colour.firstBatch;
    const auto grain =
        static_cast<std::int32_t>(std::int64_t{kGrain} * batches / std::max(1, colour.springs)) + 1;
    parallelFor(batches, grain, [&](std::int32_t begin, std::int32_t end) {
      thread_local std::vector<Kernel::Row> rows;
      if (rows.size() < longest) rows.resize(longest);
      Kernel::solver<kMeasured>(!gamma_.empty())(arrays, colour.firstBatch + begin,
                                                 colour.firstBatch + end, rows.data());
    });
  }
  storeBodies(p);
}

void LineProjection::loadBodies(const ScalarArray& inverseMass, const Particles& p) {
  const auto slots = static_cast<std::size_t>(p.slots);
  bodies_.resize(static_cast<std::size_t>(placeOf(p.slots)) + 1);
  forParts(slots, [&](std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) {
      bodies_[placeOf(static_cast<std::int32_t>(k))] = {{p.x.x[k], p.x.y[k], p.x.z[k]},
                                                        inverseMass[k]};
    }
  });
}

void LineProjection::storeBodies(Particles& p) const {
  forParts(static_cast<std::size_t>(p.slots), [&](std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) {
      const Body& body = bodies_[placeOf(static_cast<std::int32_t>(k))];
      p.x.set(k, Vec3(body.x[0], body.x[1], body.x[2]));
    }
  });
}

void LineProjection::project(const SpringLines& lines, const ScalarArray& inverseMass,
                             Particles& particles, VectorArray& pull) {
  run<false>(lines, inverseMass, particles, pull, nullptr);
}

void LineProjection::projectAndMeasure(const SpringLines& lines, const ScalarArray& inverseMass,
                                       Particles& particles, VectorArray& pull,
                                       ScalarArray& moved) {
  run<true>(lines, inverseMass, particles, pull, moved.data());
}

}  // namespace cloth_sim
