#pragma once
/// \file Particles in the form in which lines of springs are projected.

#include "linalg/vector_array.h"

namespace cloth_sim {

/// Positions in pairs of floats, the nearest one and a rest: so they have 48 bits, and the vector
/// between two particles is exact to 6e-8 of its length wherever the cloth is. The particles follow
/// the order of their slots.
class LineBodies {
 public:
  /// A particle; its position is `near` + `offset`.
  struct alignas(32) Body {
    float near[3];    ///< the position, rounded [m]
    float w;          ///< inverse inertia [1/kg]
    float offset[3];  ///< [m]
    float moved;      ///< sum of the lengths by which lines moved it [m], if measured
  };
  /// Position at the start of the substep, less `near` [m].
  struct alignas(16) Start {
    float offset[3];
    float unused;
  };

  /// Place of the particle of a slot in the arrays. Four unused entries after every 128 keep the
  /// rows of a grid, whose length is often a power of two, out of each other's cache sets.
  static std::uint32_t placeOf(std::int32_t slot) {
    const auto k = static_cast<std::uint32_t>(slot);
    return k + k / kRun * kGap;
  }

  /// \param x            positions, by particle slot [m].
  /// \param inverseMass  by particle slot [1/kg]; 0: held.
  void load(const VectorArray& x, const ScalarArray& inverseMass);
  /// After `load`. \param start  positions at the start of the substep, by particle slot [m].
  void loadStarts(const VectorArray& start);
  /// Adds what the particles were moved to the positions that were loaded, which keep all their
  /// digits.
  void store(VectorArray& x) const;
  /// The same; finds how far the lines displaced each particle in vain.
  /// \param cancelled  by particle slot: half of the difference between `moved` and the distance
  ///                   from where it was loaded [m].
  void store(VectorArray& x, ScalarArray& cancelled) const;

  char* bodies() { return reinterpret_cast<char*>(bodies_.data()); }
  const char* starts() const { return reinterpret_cast<const char*>(starts_.data()); }

 private:
  struct Kernel;

  static constexpr std::uint32_t kRun = 128;
  static constexpr std::uint32_t kGap = 4;

  template <typename Visit>
  static void forRuns(std::size_t slots, const Visit& visit);

  CacheAlignedVector<Body> bodies_;
  CacheAlignedVector<Start> starts_;  ///< by place; empty without dashpots
};

}  // namespace cloth_sim
