#include "closest_points.h"

#include <algorithm>
#include <cmath>

namespace cloth_sim {
namespace {

double clampToUnit(double value) { return std::min(1.0, std::max(0.0, value)); }

/// The fraction of the segment from `a` to `b` at which it is closest to `p`.
double closestOnSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double square = ab.squaredNorm();
  return square > 0.0 ? clampToUnit(ab.dot(p - a) / square) : 0.0;
}

/// The closest point of a triangle without area, which is one of its sides.
std::array<double, 3> closestOnLongestSide(const Vec3& p, const Corners& triangle) {
  int longest = 0;
  for (int k = 1; k < 3; ++k) {
    const double length = (triangle[(k + 1) % 3] - triangle[k]).squaredNorm();
    if (length > (triangle[(longest + 1) % 3] - triangle[longest]).squaredNorm()) longest = k;
  }
  const double t = closestOnSegment(p, triangle[longest], triangle[(longest + 1) % 3]);
  std::array<double, 3> weight{};
  weight[longest] = 1.0 - t;
  weight[(longest + 1) % 3] = t;
  return weight;
}

/// Keeps the direction with the smaller distance.
void keepClosest(const Vec3& fromBToA, SeparatingDirection& closest) {
  const double distance = fromBToA.norm();
  if (closest.distance >= 0.0 && distance >= closest.distance) return;
  closest.distance = distance;
  closest.direction = distance > 0.0 ? Vec3(fromBToA / distance) : Vec3(Vec3::Zero());
}

Vec3 pointOn(const Corners& triangle, const std::array<double, 3>& weight) {
  return weight[0] * triangle[0] + weight[1] * triangle[1] + weight[2] * triangle[2];
}

/// Distance by which all of `a` is beyond all of `b` along `direction`.
double separationAlong(const Vec3& direction, const Corners& a, const Corners& b) {
  const auto along = [&](const Vec3& p) { return direction.dot(p); };
  return std::min({along(a[0]), along(a[1]), along(a[2])}) -
         std::max({along(b[0]), along(b[1]), along(b[2])});
}

}  // namespace

std::array<double, 3> closestOnTriangle(const Vec3& p, const Corners& triangle) {
  const Vec3& a = triangle[0];
  const Vec3 ab = triangle[1] - a;
  const Vec3 ac = triangle[2] - a;
  const Vec3 ap = p - a;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {1.0, 0.0, 0.0};
  const Vec3 bp = p - triangle[1];
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {0.0, 1.0, 0.0};
  const Vec3 cp = p - triangle[2];
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 0.0, 1.0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 > 0.0 && d3 < 0.0) {
    const double t = d1 / (d1 - d3);
    return {1.0 - t, t, 0.0};
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 > 0.0 && d6 < 0.0) {
    const double t = d2 / (d2 - d6);
    return {1.0 - t, 0.0, t};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 > 0.0 && d5 - d6 > 0.0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0.0, 1.0 - t, t};
  }
  const double sum = va + vb + vc;
  if (!(sum > 0.0)) return closestOnLongestSide(p, triangle);
  return {1.0 - vb / sum - vc / sum, vb / sum, vc / sum};
}

double angleAt(const Vec3& corner, const Vec3& a, const Vec3& b) {
  return std::atan2((a - corner).cross(b - corner).norm(), (a - corner).dot(b - corner));
}

SegmentPoints closestOnSegments(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  const Vec3 u = a1 - a0;
  const Vec3 v = b1 - b0;
  const Vec3 w = a0 - b0;
  const double a = u.squaredNorm();
  const double e = v.squaredNorm();
  const double f = v.dot(w);
  if (a == 0.0) return {0.0, closestOnSegment(a0, b0, b1)};
  if (e == 0.0) return {closestOnSegment(b0, a0, a1), 0.0};
  const double c = u.dot(w);
  const double b = u.dot(v);
  const double determinant = a * e - b * b;
  SegmentPoints points;
  if (determinant > 1e-14 * a * e) points.s = clampToUnit((b * f - c * e) / determinant);
  points.t = (b * points.s + f) / e;
  if (points.t < 0.0) return {clampToUnit(-c / a), 0.0};
  if (points.t > 1.0) return {clampToUnit((b - c) / a), 1.0};
  return points;
}

SeparatingDirection separate(const Corners& a, const Corners& b) {
  SeparatingDirection closest;
  closest.distance = -1.0;
  for (int k = 0; k < 3; ++k) {
    keepClosest(a[k] - pointOn(b, closestOnTriangle(a[k], b)), closest);
    keepClosest(pointOn(a, closestOnTriangle(b[k], a)) - b[k], closest);
  }
  for (int i = 0; i < 3; ++i) {
    const Vec3& a0 = a[i];
    const Vec3& a1 = a[(i + 1) % 3];
    for (int j = 0; j < 3; ++j) {
      const Vec3& b0 = b[j];
      const Vec3& b1 = b[(j + 1) % 3];
      const SegmentPoints at = closestOnSegments(a0, a1, b0, b1);
      keepClosest(a0 + at.s * (a1 - a0) - (b0 + at.t * (b1 - b0)), closest);
    }
  }
  // Triangles that intersect without a corner of one inside the other have close edges only.
  closest.distance = std::min(closest.distance, separationAlong(closest.direction, a, b));
  return closest;
}

SeparatingDirection separateAtVertex(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b) {
  // The direction is that of the point of the hull of {a, -b} that is closest to the origin: it has
  // a positive product with each of the four vectors. Unit vectors give the cones equal weight.
  const std::array<Vec3, 4> hull{a[0].normalized(), a[1].normalized(), -b[0].normalized(),
                                 -b[1].normalized()};
  SeparatingDirection best;
  for (int skipped = 0; skipped < 4; ++skipped) {
    Corners side;
    for (int k = 0, to = 0; k < 4; ++k) {
      if (k != skipped) side[to++] = hull[k];
    }
    const Vec3 point = pointOn(side, closestOnTriangle(Vec3::Zero(), side));
    const double length = point.norm();
    if (!(length > 1e-12)) continue;
    const Vec3 n = point / length;
    const double apart = std::min({n.dot(a[0]), n.dot(a[1]), -n.dot(b[0]), -n.dot(b[1])});
    if (apart > best.distance) best = {n, apart};
  }
  return best;
}

SeparatingDirection separateHinge(const Vec3& edge, const Vec3& a, const Vec3& b) {
  const Vec3 along = edge.normalized();
  const Vec3 heightA = a - along.dot(a) * along;
  const Vec3 heightB = b - along.dot(b) * along;
  const Vec3 between = heightA.normalized() - heightB.normalized();
  const double length = between.norm();
  if (!(length > 1e-12)) return {};
  const Vec3 n = between / length;
  return {n, std::min(n.dot(heightA), -n.dot(heightB))};
}

}  // namespace cloth_sim
