#pragma once
/// \file Arithmetic on packed vectors, one axis at a time.

#include "cloth_sim/solver/packed_particles.h"

namespace cloth_sim {

/// Calls `body` with the x arrays of all vectors, then with y, then with z.
template <typename Body, typename... Vectors>
void forAxes(const Body& body, Vectors&... vectors) {
  body(vectors.x...);
  body(vectors.y...);
  body(vectors.z...);
}

/// All coordinates of `n` particles zero.
void setZero(std::size_t n, PackedVectors& a);
/// a = b + s c.
void setSum(const PackedVectors& b, double s, const PackedVectors& c, PackedVectors& a);
/// a *= s.
void scale(double s, PackedVectors& a);
/// a += s b.
void addScaled(double s, const PackedVectors& b, PackedVectors& a);
/// Sum over all coordinates of a b, in an order that depends on nothing but the size.
double dot(const PackedVectors& a, const PackedVectors& b);

}  // namespace cloth_sim
