#pragma once
/// \file Arrays of numbers and of 3-vectors, one entry per particle slot, coordinates apart
/// (structure of arrays).

#include "cloth_sim/types.h"
#include "support/cache_aligned.h"

namespace cloth_sim {

/// One number per particle slot.
using ScalarArray = CacheAlignedVector<double>;

/// A 3-vector per particle slot; x, y and z have the same size.
struct VectorArray {
  ScalarArray x, y, z;

  void resize(std::size_t n) {
    x.resize(n);
    y.resize(n);
    z.resize(n);
  }
  Vec3 at(std::size_t k) const { return Vec3(x[k], y[k], z[k]); }
  void set(std::size_t k, const Vec3& p) {
    x[k] = p.x();
    y[k] = p.y();
    z[k] = p.z();
  }
};

/// Coordinates of consecutive slots, for kernels.
struct Axes {
  double *x, *y, *z;
};
struct ConstAxes {
  const double *x, *y, *z;
};

/// The coordinates from slot k on.
inline Axes axesAt(VectorArray& v, std::int32_t k) {
  return {v.x.data() + k, v.y.data() + k, v.z.data() + k};
}
inline ConstAxes axesAt(const VectorArray& v, std::int32_t k) {
  return {v.x.data() + k, v.y.data() + k, v.z.data() + k};
}

}  // namespace cloth_sim
