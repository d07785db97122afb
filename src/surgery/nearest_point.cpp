#include "nearest_point.h"

#include <algorithm>

namespace cloth_sim {

Vec3 nearestPoint(const std::array<Vec3, 2>& segment, const Vec3& p) {
  const auto& [a, b] = segment;
  const Vec3 d = b - a;
  const double squared = d.squaredNorm();
  if (squared == 0.0) return a;
  return a + std::clamp(d.dot(p - a) / squared, 0.0, 1.0) * d;
}

Vec3 nearestPoint(const std::array<Vec3, 3>& triangle, const Vec3& p) {
  const auto& [a, b, c] = triangle;
  const Vec3 normal = (b - a).cross(c - a);
  const double squared = normal.squaredNorm();
  const bool inside = squared > 0.0 && (b - a).cross(p - a).dot(normal) >= 0.0 &&
                      (c - b).cross(p - b).dot(normal) >= 0.0 &&
                      (a - c).cross(p - c).dot(normal) >= 0.0;
  if (inside) return p - normal * (normal.dot(p - a) / squared);
  Vec3 best = nearestPoint(std::array{a, b}, p);
  for (const Vec3& other : {nearestPoint(std::array{b, c}, p), nearestPoint(std::array{c, a}, p)}) {
    if ((other - p).squaredNorm() < (best - p).squaredNorm()) best = other;
  }
  return best;
}

}  // namespace cloth_sim
