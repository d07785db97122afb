#include "line_bodies.h"

#include <algorithm>
#include <cmath>

#include "support/simd.h"
#include "support/vector_clones.h"
#include "threads/parallel_for.h"

namespace cloth_sim {

/// Four particles at a time: the eight floats of a body are a row of two 4 x 4 matrices, whose
/// columns are coordinates.
struct LineBodies::Kernel {
  [[gnu::always_inline]] static FloatHalf rounded(const Lanes& of) {
    return __builtin_convertvector(of, FloatHalf);
  }
  [[gnu::always_inline]] static Lanes widened(const FloatHalf& of) {
    return __builtin_convertvector(of, Lanes);
  }
  /// The float nearest to each coordinate, and the float nearest to its rest.
  [[gnu::always_inline]] static FloatLanes split(const Lanes& of) {
    const FloatHalf near = rounded(of);
    return join(near, rounded(of - widened(near)));
  }
  /// A coordinate after what its body was moved.
  /// \param pair  `near` and `offset`.
  [[gnu::always_inline]] static Lanes moved(const Lanes& before, const FloatLanes& pair) {
    const FloatHalf rest = rounded(before - widened(lowHalf(pair)));
    return before + (widened(highHalf(pair)) - widened(rest));
  }
  [[gnu::always_inline]] static Lanes sumOf(const FloatLanes& pair) {
    return widened(lowHalf(pair)) + widened(highHalf(pair));
  }
  [[gnu::always_inline]] static FloatLanes& rowOf(Body& body) {
    return *reinterpret_cast<FloatLanes*>(&body);
  }
  [[gnu::always_inline]] static const FloatLanes& rowOf(const Body& body) {
    return *reinterpret_cast<const FloatLanes*>(&body);
  }

  [[gnu::always_inline]] static void loadFour(const Lanes& x, const Lanes& y, const Lanes& z,
                                              const Lanes& w, Body* to) {
    FloatLanes a = split(x), b = split(y), c = split(z), d = join(rounded(w), FloatHalf{});
    transposeHalves(a, b, c, d);
    rowOf(to[0]) = a;
    rowOf(to[1]) = b;
    rowOf(to[2]) = c;
    rowOf(to[3]) = d;
  }
  template <bool kMeasured>
  [[gnu::always_inline]] static void storeFour(const Body* from, Lanes& x, Lanes& y, Lanes& z,
                                               Lanes& cancelled) {
    FloatLanes a = rowOf(from[0]), b = rowOf(from[1]), c = rowOf(from[2]), d = rowOf(from[3]);
    transposeHalves(a, b, c, d);
    if constexpr (kMeasured) {
      const Lanes byX = sumOf(a) - x, byY = sumOf(b) - y, byZ = sumOf(c) - z;
      cancelled = 0.5 * (widened(highHalf(d)) - sqrt(byX * byX + byY * byY + byZ * byZ));
    }
    x = moved(x, a);
    y = moved(y, b);
    z = moved(z, c);
  }

  /// The first `count` of four numbers; the others are zero.
  static Lanes some(const double* from, std::size_t count) {
    Lanes all{};
    for (std::size_t k = 0; k < count; ++k) all[k] = from[k];
    return all;
  }
  static void putSome(const Lanes& from, std::size_t count, double* to) {
    for (std::size_t k = 0; k < count; ++k) to[k] = from[k];
  }

  CLOTH_SIM_VECTOR_CLONES
  static void load(ConstAxes x, const double* w, std::size_t count, Body* to) {
    std::size_t k = 0;
    for (; k + kLanes <= count; k += kLanes) {
      loadFour(lanesAt(x.x + k), lanesAt(x.y + k), lanesAt(x.z + k), lanesAt(w + k), to + k);
    }
    if (k == count) return;
    const std::size_t rest = count - k;
    Body bodies[kLanes];
    loadFour(some(x.x + k, rest), some(x.y + k, rest), some(x.z + k, rest), some(w + k, rest),
             bodies);
    std::copy(bodies, bodies + rest, to + k);
  }

  template <bool kMeasured>
  [[gnu::always_inline]] static void storeAll(const Body* from, std::size_t count, Axes x,
                                              double* cancelled) {
    Lanes unused;
    std::size_t k = 0;
    for (; k + kLanes <= count; k += kLanes) {
      storeFour<kMeasured>(from + k, lanesAt(x.x + k), lanesAt(x.y + k), lanesAt(x.z + k),
                           kMeasured ? lanesAt(cancelled + k) : unused);
    }
    if (k == count) return;
    const std::size_t rest = count - k;
    Body bodies[kLanes] = {};
    std::copy(from + k, from + count, bodies);
    Lanes lastX = some(x.x + k, rest), lastY = some(x.y + k, rest), lastZ = some(x.z + k, rest);
    Lanes last{};
    storeFour<kMeasured>(bodies, lastX, lastY, lastZ, last);
    putSome(lastX, rest, x.x + k);
    putSome(lastY, rest, x.y + k);
    putSome(lastZ, rest, x.z + k);
    if (kMeasured) putSome(last, rest, cancelled + k);
  }
  // Not templates: GCC makes no clones of those.
  CLOTH_SIM_VECTOR_CLONES
  static void store(const Body* from, std::size_t count, Axes x) {
    storeAll<false>(from, count, x, nullptr);
  }
  CLOTH_SIM_VECTOR_CLONES
  static void storeMeasured(const Body* from, std::size_t count, Axes x, double* cancelled) {
    storeAll<true>(from, count, x, cancelled);
  }
};

/// Calls `visit(slot, place, count)` for runs of slots whose places follow each other.
template <typename Visit>
void LineBodies::forRuns(std::size_t slots, const Visit& visit) {
  constexpr std::int32_t kGrain = 32;  // runs that are worth a second thread
  const auto runs = static_cast<std::int32_t>((slots + kRun - 1) / kRun);
  parallelFor(runs, kGrain, [&](std::int32_t first, std::int32_t last) {
    for (std::int32_t run = first; run < last; ++run) {
      const std::size_t slot = static_cast<std::size_t>(run) * kRun;
      visit(static_cast<std::int32_t>(slot), placeOf(static_cast<std::int32_t>(slot)),
            std::min<std::size_t>(kRun, slots - slot));
    }
  });
}

void LineBodies::load(const VectorArray& x, const ScalarArray& inverseMass) {
  const std::size_t slots = inverseMass.size();
  bodies_.resize(static_cast<std::size_t>(placeOf(static_cast<std::int32_t>(slots))) + 1);
  forRuns(slots, [&](std::int32_t slot, std::uint32_t place, std::size_t count) {
    Kernel::load(axesAt(x, slot), inverseMass.data() + slot, count, bodies_.data() + place);
  });
}

void LineBodies::loadStarts(const VectorArray& start) {
  starts_.resize(bodies_.size());
  forRuns(start.x.size(), [&](std::int32_t slot, std::uint32_t place, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3 at = start.at(static_cast<std::size_t>(slot) + k);
      for (int axis = 0; axis < 3; ++axis) {
        const auto near = static_cast<double>(bodies_[place + k].near[axis]);
        starts_[place + k].offset[axis] = static_cast<float>(at[axis] - near);
      }
    }
  });
}

void LineBodies::store(VectorArray& x) const {
  forRuns(x.x.size(), [&](std::int32_t slot, std::uint32_t place, std::size_t count) {
    Kernel::store(bodies_.data() + place, count, axesAt(x, slot));
  });
}

void LineBodies::store(VectorArray& x, ScalarArray& cancelled) const {
  forRuns(x.x.size(), [&](std::int32_t slot, std::uint32_t place, std::size_t count) {
    Kernel::storeMeasured(bodies_.data() + place, count, axesAt(x, slot), cancelled.data() + slot);
  });
}

}  // namespace cloth_sim
