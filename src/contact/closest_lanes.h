#pragma once
/// \file Closest points of four pairs of segments, or of four points and triangles, at a time.

#include <array>

#include "linalg/vector_array.h"
#include "support/simd.h"

namespace cloth_sim {

/// Four 3-vectors, coordinates apart.
struct Lanes3 {
  Lanes x, y, z;
};

[[gnu::always_inline]] inline Lanes3 gather(const ConstAxes& from, const std::int32_t* at) {
  return {gather(from.x, at), gather(from.y, at), gather(from.z, at)};
}
[[gnu::always_inline]] inline Lanes3 operator-(const Lanes3& a, const Lanes3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[gnu::always_inline]] inline Lanes3 operator+(const Lanes3& a, const Lanes3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[gnu::always_inline]] inline Lanes3 operator*(const Lanes& s, const Lanes3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
[[gnu::always_inline]] inline Lanes dot(const Lanes3& a, const Lanes3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The nearest number in [0, 1]; 0 for NaN.
[[gnu::always_inline]] inline Lanes clampToUnit(const Lanes& value) {
  const Lanes zero{};
  const Lanes one = zero + 1.0;
  const Lanes low = value > zero ? value : zero;
  return low < one ? low : one;
}

/// Closest points of four pairs of shapes with four corners together.
struct ClosestLanes {
  Lanes weight[4];  ///< of the corners: their sum points from the second to the first
  Lanes square;     ///< of the distance [m^2]
};

/// Closest points of segments p[0] p[1] and p[2] p[3] (Ericson 2005, Real-Time Collision Detection,
/// 5.1.9). Of parallel segments it finds one of the closest pairs.
[[gnu::always_inline]] inline ClosestLanes closestOnSegments(const std::array<Lanes3, 4>& p) {
  const Lanes zero{};
  const Lanes3 u = p[1] - p[0];
  const Lanes3 v = p[3] - p[2];
  const Lanes3 w = p[0] - p[2];
  const Lanes a = dot(u, u);
  const Lanes e = dot(v, v);
  const Lanes f = dot(v, w);
  const Lanes c = dot(u, w);
  const Lanes b = dot(u, v);
  const Lanes determinant = a * e - b * b;
  Lanes s = clampToUnit((b * f - c * e) / determinant);
  s = determinant > 1e-14 * a * e ? s : zero;
  const Lanes t = (b * s + f) / e;
  const Lanes inside = clampToUnit(t);
  s = t == inside ? s : clampToUnit((b * inside - c) / a);
  const Lanes3 apart = w + s * u - inside * v;
  return {{1.0 - s, s, inside - 1.0, -inside}, dot(apart, apart)};
}

/// Closest points of points p[0] and triangles p[1] p[2] p[3]. A weight is exactly 0 where the
/// point is on the opposite side of the triangle.
[[gnu::always_inline]] inline ClosestLanes closestOnTriangles(const std::array<Lanes3, 4>& p) {
  const Lanes zero{};
  const Lanes one = zero + 1.0;
  std::array<Lanes3, 3> from;  // from the corners to the point
  std::array<Lanes3, 3> side;  // from each corner to the next
  for (std::size_t k = 0; k < 3; ++k) {
    from[k] = p[0] - p[k + 1];
    side[k] = p[(k + 1) % 3 + 1] - p[k + 1];
  }
  ClosestLanes best;
  best.weight[0] = one;
  best.square = zero + 1e300;
  for (std::size_t k = 0; k < 3; ++k) {
    const Lanes t = clampToUnit(dot(side[k], from[k]) / dot(side[k], side[k]));
    const Lanes3 apart = from[k] - t * side[k];
    const Lanes square = dot(apart, apart);
    const auto isBetter = square < best.square;
    best.square = isBetter ? square : best.square;
    const std::size_t next = (k + 1) % 3;
    best.weight[k + 1] = isBetter ? t - one : best.weight[k + 1];
    best.weight[next + 1] = isBetter ? -t : best.weight[next + 1];
    best.weight[(next + 1) % 3 + 1] = isBetter ? zero : best.weight[(next + 1) % 3 + 1];
  }
  // Where the point is above the inside of the triangle, by barycentric coordinates.
  const Lanes3& ab = side[0];
  const Lanes3 ac = p[3] - p[1];
  const Lanes abab = dot(ab, ab);
  const Lanes abac = dot(ab, ac);
  const Lanes acac = dot(ac, ac);
  const Lanes apab = dot(from[0], ab);
  const Lanes apac = dot(from[0], ac);
  const Lanes determinant = abab * acac - abac * abac;
  const Lanes v = (acac * apab - abac * apac) / determinant;
  const Lanes w = (abab * apac - abac * apab) / determinant;
  const Lanes u = one - v - w;
  const auto isInside = (u > zero) & (v > zero) & (w > zero);
  const Lanes3 apart = from[0] - v * ab - w * ac;
  best.square = isInside ? dot(apart, apart) : best.square;
  best.weight[1] = isInside ? -u : best.weight[1];
  best.weight[2] = isInside ? -v : best.weight[2];
  best.weight[3] = isInside ? -w : best.weight[3];
  return best;
}

}  // namespace cloth_sim
