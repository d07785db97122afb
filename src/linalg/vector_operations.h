#pragma once
/// \file Arithmetic on arrays of 3-vectors, on several threads where that pays.

#include "threads/parallel_for.h"
#include "vector_array.h"

namespace cloth_sim {

/// Calls `body(x arrays of all vectors...)`, then the same with y and with z.
template <typename Body, typename... Vectors>
void forAxes(const Body& body, Vectors&... vectors) {
  body(vectors.x...);
  body(vectors.y...);
  body(vectors.z...);
}

/// Calls `body(first, count)` on parts of `n` particles that together cover them.
template <typename Body>
void forParts(std::size_t n, const Body& body) {
  constexpr std::int32_t kGrain = 4096;  // fewer are not worth a second thread
  parallelFor(static_cast<std::int32_t>(n), kGrain, [&](std::int32_t first, std::int32_t last) {
    body(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first));
  });
}

/// Resizes `a` to n vectors of zero.
void setZero(std::size_t n, VectorArray& a);
/// a = b.
void copy(const VectorArray& b, VectorArray& a);
/// a = b + s c.
void setSum(const VectorArray& b, double s, const VectorArray& c, VectorArray& a);
/// a = s (b - c).
void setDifference(const VectorArray& b, const VectorArray& c, double s, VectorArray& a);
/// a = b + s (b - c).
void setExtrapolation(const VectorArray& b, const VectorArray& c, double s, VectorArray& a);
/// a += s b.
void addScaled(double s, const VectorArray& b, VectorArray& a);
/// The inner product of all coordinates, summed in an order that depends on the size alone.
double dot(const VectorArray& a, const VectorArray& b);

}  // namespace cloth_sim
