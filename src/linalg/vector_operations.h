#pragma once
/// \file Arithmetic on packed vectors, on several threads where that pays.

#include "threads/parallel_for.h"
#include "vector_array.h"

namespace cloth_sim {

/// Calls `body` with the x arrays of all vectors, then with y, then with z.
template <typename Body, typename... Vectors>
void forAxes(const Body& body, Vectors&... vectors) {
  body(vectors.x...);
  body(vectors.y...);
  body(vectors.z...);
}

/// Calls `body(first, count)` on parts of `n` particles that together cover them.
template <typename Body>
void forParts(std::size_t n, const Body& body) {
  constexpr std::int32_t kGrain = 4096;  // so many are worth a second thread
  parallelFor(static_cast<std::int32_t>(n), kGrain, [&](std::int32_t first, std::int32_t last) {
    body(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first));
  });
}

/// All coordinates of `n` particles zero.
void setZero(std::size_t n, VectorArray& a);
/// a = b.
void copy(const VectorArray& b, VectorArray& a);
/// a = b + s c.
void setSum(const VectorArray& b, double s, const VectorArray& c, VectorArray& a);
/// a = s (b - c).
void setDifference(const VectorArray& b, const VectorArray& c, double s, VectorArray& a);
/// a += s b.
void addScaled(double s, const VectorArray& b, VectorArray& a);
/// Sum over all coordinates of a b, in an order that depends on nothing but the size.
double dot(const VectorArray& a, const VectorArray& b);

}  // namespace cloth_sim
