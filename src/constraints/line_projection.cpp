#include "line_projection.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <unordered_map>

#include "support/vector_clones.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Compliance of a place without a spring [1/kg]: it pulls nothing.
constexpr float kNoSpring = 1e30F;
/// Added to squares of lengths, so that no length is zero [m^2].
constexpr float kLeastSquare = 1e-24F;
/// Steps of blocks that are worth a thread of their own.
constexpr std::int32_t kGrainSteps = 256;

/// Calls `solve(begin, end)` for ranges of the blocks of a colour that have about as many steps
/// each, on several threads.
template <typename Solve>
void forParts(const SpringLines& lines, const SpringLines::Colour& colour, const Solve& solve) {
  const SpringLines::SimdBlock* const blocks = lines.blocks().data();
  const SpringLines::SimdBlock* const first = blocks + colour.firstBlock;
  const SpringLines::SimdBlock* const end = blocks + colour.endBlock;
  const auto blockAt = [&](std::int32_t step) {
    const auto isBefore = [](const SpringLines::SimdBlock& block, std::int32_t at) {
      return block.firstStep < at;
    };
    const auto found = std::lower_bound(first, end, first->firstStep + step, isBefore);
    return static_cast<std::int32_t>(found - blocks);
  };
  const std::int32_t steps = end[-1].firstStep + end[-1].steps - first->firstStep;
  parallelFor(steps, kGrainSteps,
              [&](std::int32_t begin, std::int32_t last) { solve(blockAt(begin), blockAt(last)); });
}

}  // namespace

void LineProjection::prepare(const SpringLines& lines, const SpringNetwork& springs) {
  sources_.clear();
  firstParameters_.clear();
  bool isDamped = false;
  std::unordered_map<std::string, std::int32_t> known;  // contents of a block -> its first source
  for (const SpringLines::SimdBlock& block : lines.blocks()) {
    const auto first = static_cast<std::int32_t>(sources_.size());
    for (std::int32_t s = 0; s < block.steps; ++s) {
      sources_.push_back(sourceOf(lines.springs()[block.firstStep + s], springs));
      for (const double damping : sources_.back().damping) isDamped |= damping > 0.0;
    }
    const std::string content(reinterpret_cast<const char*>(sources_.data() + first),
                              sizeof(Source) * static_cast<std::size_t>(block.steps));
    const auto [entry, isNew] = known.emplace(content, first);
    firstParameters_.push_back(entry->second);
    if (!isNew) sources_.resize(static_cast<std::size_t>(first));
  }
  parameters_.resize(sources_.size());
  gamma_.resize(isDamped ? kWidth * sources_.size() : 0);
  findOffsets(lines);
}

LineProjection::Source LineProjection::sourceOf(const SpringLines::Slots& slots,
                                                const SpringNetwork& springs) {
  Source source{};
  for (std::size_t lane = 0; lane < kWidth; ++lane) {
    if (slots[lane] == kNone) continue;
    const Spring spring = springs[slots[lane]];
    source.restLength[lane] = spring.restLength;
    source.stiffness[lane] = spring.stiffness;
    source.damping[lane] = spring.damping;
  }
  return source;
}

void LineProjection::findOffsets(const SpringLines& lines) {
  offsets_.resize(lines.slots().size());
  for (std::size_t k = 0; k < offsets_.size(); ++k) {
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
      offsets_[k][lane] = LineBodies::placeOf(lines.slots()[k][lane]) *
                          static_cast<std::uint32_t>(sizeof(LineBodies::Body));
    }
  }
}

void LineProjection::setStep(double h) {
  for (std::size_t k = 0; k < sources_.size(); ++k) {
    const Source& source = sources_[k];
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
      const bool pulls = source.stiffness[lane] > 0.0;
      const double gamma = pulls ? source.damping[lane] / (source.stiffness[lane] * h) : 0.0;
      parameters_[k].restLength[lane] = static_cast<float>(source.restLength[lane]);
      parameters_[k].compliance[lane] =
          pulls ? static_cast<float>(1.0 / (source.stiffness[lane] * h * h * (1.0 + gamma)))
                : kNoSpring;
      if (!gamma_.empty()) gamma_[kWidth * k + lane] = static_cast<float>(gamma);
    }
  }
}

/// The direct solves of the lines of a block at once. The unknowns are nu = mu / l, and each row of
/// the system is multiplied by l: then its entries are products of d, the vectors between the ends
/// of springs, instead of unit vectors, and no spring needs a division besides that of its pivot.
struct LineProjection::Kernel {
  using Slots = SpringLines::Slots;
  using Offsets = std::array<std::uint32_t, kWidth>;
  using SimdBlock = SpringLines::SimdBlock;

  /// Copied coordinate by coordinate: GCC copies the whole in halves of vectors, which then wait
  /// for each other.
  struct Vectors {
    FloatLanes x, y, z;
    Vectors() = default;
    [[gnu::always_inline]] Vectors(const FloatLanes& ofX, const FloatLanes& ofY,
                                   const FloatLanes& ofZ)
        : x(ofX), y(ofY), z(ofZ) {}
    [[gnu::always_inline]] Vectors(const Vectors& other) : x(other.x), y(other.y), z(other.z) {}
    [[gnu::always_inline]] Vectors& operator=(const Vectors& other) {
      x = other.x;
      y = other.y;
      z = other.z;
      return *this;
    }
  };
  /// Particles, one a lane.
  struct Bodies {
    Vectors near, offset;
    FloatLanes w, moved;
    Bodies() = default;
    [[gnu::always_inline]] Bodies(const Bodies& other)
        : near(other.near), offset(other.offset), w(other.w), moved(other.moved) {}
    [[gnu::always_inline]] Bodies& operator=(const Bodies& other) {
      near = other.near;
      offset = other.offset;
      w = other.w;
      moved = other.moved;
      return *this;
    }
  };
  /// Kept of each step from the pass forwards for the one back. The multiplier is
  /// `own` - `factor` of the next step * multiplier of the next step.
  struct Row {
    Vectors d;     ///< from begin to end of each spring [m]
    Vectors end;   ///< `LineBodies::Body::offset` of the particles at the end of the springs [m]
    FloatLanes w;  ///< their inverse masses
    FloatLanes moved;   ///< their `LineBodies::Body::moved`, if measured
    FloatLanes own;     ///< right side over pivot
    FloatLanes factor;  ///< of the elimination of the step before
  };
  /// Arrays that it reads and writes; passed by value, so that they stay in registers.
  struct Arrays {
    const SimdBlock* blocks;
    const Slots* slots;
    const Parameters* parameters;
    const float* gamma;
    const std::int32_t* firstParameters;
    const Offsets* offsets;
    char* bodies;
    const char* starts;
    double *pullX, *pullY, *pullZ;
  };

  [[gnu::always_inline]] static FloatLanes dot(const Vectors& a, const Vectors& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }
  [[gnu::always_inline]] static Vectors difference(const Vectors& a, const Vectors& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  [[gnu::always_inline]] static Vectors sum(const Vectors& a, const Vectors& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }

  /// Loads four consecutive floats for each lane, from `base` plus its offset.
  [[gnu::always_inline]] static void loadFours(const char* base, const Offsets& at, FloatLanes& a,
                                               FloatLanes& b, FloatLanes& c, FloatLanes& d) {
    const auto four = [&](int lane) {
      return *reinterpret_cast<const FloatHalf*>(base + at[lane]);
    };
    a = join(four(0), four(4));
    b = join(four(1), four(5));
    c = join(four(2), four(6));
    d = join(four(3), four(7));
    transposeHalves(a, b, c, d);
  }
  [[gnu::always_inline]] static void load(const Arrays& m, const Offsets& at, Bodies& all) {
    loadFours(m.bodies, at, all.near.x, all.near.y, all.near.z, all.w);
    loadFours(m.bodies + offsetof(LineBodies::Body, offset), at, all.offset.x, all.offset.y,
              all.offset.z, all.moved);
  }
  /// Stores what changes. Lanes without a line name the same particles as the lane before, which
  /// is written last.
  [[gnu::always_inline]] static void store(const Arrays& m, const Offsets& at,
                                           const Vectors& offset, const FloatLanes& moved) {
    FloatLanes a = offset.x, b = offset.y, c = offset.z, d = moved;
    transposeHalves(a, b, c, d);
    char* const base = m.bodies + offsetof(LineBodies::Body, offset);
    const auto four = [&](int lane) -> FloatHalf& {
      return *reinterpret_cast<FloatHalf*>(base + at[lane]);
    };
    four(7) = highHalf(d);
    four(6) = highHalf(c);
    four(5) = highHalf(b);
    four(4) = highHalf(a);
    four(3) = lowHalf(d);
    four(2) = lowHalf(c);
    four(1) = lowHalf(b);
    four(0) = lowHalf(a);
  }
  /// Displacements in the substep.
  [[gnu::always_inline]] static Vectors displacement(const Arrays& m, const Offsets& at,
                                                     const Vectors& offset) {
    Offsets places;
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
      places[lane] = at[lane] / static_cast<std::uint32_t>(sizeof(LineBodies::Body) /
                                                           sizeof(LineBodies::Start));
    }
    Vectors start;
    FloatLanes unused;
    loadFours(m.starts, places, start.x, start.y, start.z, unused);
    return difference(offset, start);
  }

  /// State of the pass forwards.
  struct Forward {
    Bodies begin;          ///< particles at the beginning of the next springs
    Vectors displacement;  ///< theirs in the substep [m]
    Vectors d;             ///< of the springs before, from their begin to their end
    FloatLanes inverse;    ///< of their pivots; zero at the first springs
    FloatLanes rightSide;  ///< theirs after elimination
    FloatLanes leastW;     ///< least inverse mass so far
  };

  /// Eliminates a step whose springs end at the particles at `at`.
  template <bool kDamped, bool kMeasured>
  [[gnu::always_inline]] static void eliminate(const Arrays& m, const Offsets& at,
                                               const Parameters& springs,
                                               [[maybe_unused]] const float* gamma, Forward& f,
                                               Row& row) {
    Bodies end;
    load(m, at, end);
    const Vectors d =
        sum(difference(end.near, f.begin.near), difference(end.offset, f.begin.offset));
    const FloatLanes squared = dot(d, d) + kLeastSquare;
    FloatLanes error = squared - floatLanesAt(springs.restLength) * sqrt(squared);
    if constexpr (kDamped) {
      const Vectors displaced = displacement(m, at, end.offset);
      const FloatLanes g = floatLanesAt(gamma);
      error = (error + g * dot(d, difference(displaced, f.displacement))) / (1.0F + g);
      f.displacement = displaced;
    }
    const FloatLanes off = -f.begin.w * dot(d, f.d);
    const FloatLanes factor = off * f.inverse;
    const FloatLanes diagonal = f.begin.w + end.w + floatLanesAt(springs.compliance);
    f.inverse = 1.0F / (diagonal * squared - factor * off);
    f.rightSide = error - factor * f.rightSide;
    f.leastW = end.w < f.leastW ? end.w : f.leastW;
    f.begin = end;
    f.d = d;
    row.d = d;
    row.end = end.offset;
    row.w = end.w;
    if constexpr (kMeasured) row.moved = end.moved;
    row.own = f.rightSide * f.inverse;
    row.factor = factor;
  }

  /// Moves particles by the pull of the springs on both sides.
  /// \param offset  where they are, less `LineBodies::Body::near`.
  template <bool kMeasured>
  [[gnu::always_inline]] static void move(const Arrays& m, const Offsets& at, const Vectors& offset,
                                          const FloatLanes& w, const FloatLanes& moved,
                                          const Vectors& pull) {
    const Vectors by{w * pull.x, w * pull.y, w * pull.z};
    if constexpr (kMeasured) {
      store(m, at, sum(offset, by), moved + sqrt(dot(by, by)));
    } else {
      store(m, at, sum(offset, by), w);  // nobody reads `moved`
    }
  }

  /// Adds what the springs do to held particles.
  static void recordPull(const Arrays& m, const Slots& slots, const FloatLanes& w,
                         const Vectors& pull) {
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
      if (w[lane] != 0.0F) continue;
      const std::int32_t slot = slots[lane];
      m.pullX[slot] += static_cast<double>(pull.x[lane]);
      m.pullY[slot] += static_cast<double>(pull.y[lane]);
      m.pullZ[slot] += static_cast<double>(pull.z[lane]);
    }
  }
  static bool hasZero(const FloatLanes& of) {
    bool found = false;
    for (std::size_t lane = 0; lane < kWidth; ++lane) found |= of[lane] == 0.0F;
    return found;
  }

  /// Finds the multipliers from the last step to the first, and moves the particles.
  /// \param kHolds  some particles are held.
  template <bool kMeasured, bool kHolds>
  [[gnu::always_inline]] static void substitute(const Arrays& m, const SimdBlock& block,
                                                const Bodies& first, const Row* rows) {
    const Slots* const slots = m.slots + block.firstPlace;
    const Offsets* const offsets = m.offsets + block.firstPlace;
    const FloatLanes zero{};
    Vectors after(zero, zero, zero);  // pull of the springs beyond the particle, mu n
    FloatLanes factor = zero, nu = zero;
    for (std::ptrdiff_t s = block.steps; s-- > 0;) {
      const Row& row = rows[s];
      nu = row.own - factor * nu;
      factor = row.factor;
      const Vectors own{nu * row.d.x, nu * row.d.y, nu * row.d.z};
      const Vectors pull = difference(after, own);
      move<kMeasured>(m, offsets[s + 1], row.end, row.w, row.moved, pull);
      if (kHolds && hasZero(row.w)) recordPull(m, slots[s + 1], row.w, pull);
      after = own;
    }
    move<kMeasured>(m, offsets[0], first.offset, first.w, first.moved, after);
    if (kHolds && hasZero(first.w)) recordPull(m, slots[0], first.w, after);
  }

  /// Solves the lines of a block.
  template <bool kDamped, bool kMeasured>
  [[gnu::always_inline]] static void solve(const Arrays& m, std::ptrdiff_t index, Row* rows) {
    const SimdBlock& block = m.blocks[index];
    const Offsets* const offsets = m.offsets + block.firstPlace;
    const Parameters* const parameters = m.parameters + m.firstParameters[index];
    const float* const gamma = m.gamma + (kDamped ? kWidth * m.firstParameters[index] : 0);
    const std::ptrdiff_t steps = block.steps;
    const FloatLanes zero{};
    Bodies first;
    load(m, offsets[0], first);
    Forward f;
    f.begin = first;
    f.d = Vectors(zero, zero, zero);
    f.inverse = zero;
    f.rightSide = zero;
    f.leastW = first.w;
    if constexpr (kDamped) f.displacement = displacement(m, offsets[0], first.offset);
    for (std::ptrdiff_t s = 0; s < steps; ++s) {
      eliminate<kDamped, kMeasured>(m, offsets[s + 1], parameters[s],
                                    kDamped ? gamma + kWidth * s : nullptr, f, rows[s]);
    }
    if (hasZero(f.leastW)) {
      substitute<kMeasured, true>(m, block, first, rows);
    } else {
      substitute<kMeasured, false>(m, block, first, rows);
    }
  }

  template <bool kDamped, bool kMeasured>
  [[gnu::always_inline]] static void solveAll(const Arrays& arrays, std::ptrdiff_t begin,
                                              std::ptrdiff_t end, Row* rows) {
    const Arrays m = arrays;
    for (std::ptrdiff_t k = begin; k < end; ++k) solve<kDamped, kMeasured>(m, k, rows);
  }

  // These are no templates: GCC makes no clones of templates.
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
void LineProjection::run(const SpringLines& lines, const ScalarArray& inverseMass,
                         const Particles& p, VectorArray& pull) {
  bodies_.load(p.x, inverseMass);
  if (!gamma_.empty()) bodies_.loadStarts(p.start);
  const Kernel::Arrays arrays{
      lines.blocks().data(),   lines.slots().data(), parameters_.data(), gamma_.data(),
      firstParameters_.data(), offsets_.data(),      bodies_.bodies(),   bodies_.starts(),
      pull.x.data(),           pull.y.data(),        pull.z.data()};
  const auto longest = static_cast<std::size_t>(lines.longest());
  for (const SpringLines::Colour& colour : lines.colours()) {
    forParts(lines, colour, [&](std::int32_t begin, std::int32_t end) {
      thread_local std::vector<Kernel::Row> rows;
      if (rows.size() < longest) rows.resize(longest);
      Kernel::solver<kMeasured>(!gamma_.empty())(arrays, begin, end, rows.data());
    });
  }
}

void LineProjection::project(const SpringLines& lines, const ScalarArray& inverseMass,
                             Particles& particles, VectorArray& pull) {
  run<false>(lines, inverseMass, particles, pull);
  bodies_.store(particles.x);
}

void LineProjection::projectAndMeasure(const SpringLines& lines, const ScalarArray& inverseMass,
                                       Particles& particles, VectorArray& pull,
                                       ScalarArray& cancelled) {
  run<true>(lines, inverseMass, particles, pull);
  bodies_.store(particles.x, cancelled);
}

}  // namespace cloth_sim
