#include "face_pair.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cloth_sim {
namespace {

/// Factor by which the corners of two faces with a common edge are farther apart than the edge is
/// tilted.
constexpr double kMostTilt = 4.0;

Corners cornersOf(const Face& face, const std::vector<Vec3>& x) {
  return {x[face[0]], x[face[1]], x[face[2]]};
}

/// Moves the corners of both faces that they share to the end, in the same order.
std::int32_t sortShared(Face& a, Face& b) {
  std::int32_t shared = 0;
  for (int k = 2; k >= 0; --k) {
    const auto same = std::find(b.begin(), b.end() - shared, a[k]);
    if (same == b.end() - shared) continue;
    ++shared;
    std::swap(*same, b[3 - shared]);
    std::swap(a[k], a[3 - shared]);
  }
  return shared;
}

/// The unit normal of a face on the side of `direction`.
Vec3 normalTowards(const Vec3& direction, const Face& face, const std::vector<Vec3>& x) {
  const Vec3 n = (x[face[1]] - x[face[0]]).cross(x[face[2]] - x[face[0]]).normalized();
  return n.dot(direction) < 0.0 ? Vec3(-n) : n;
}

/// Returns the distance of face a beyond face b along the direction of the pair [m].
double separationOf(const FacePair& pair, const std::vector<Vec3>& x) {
  const Vec3& n = pair.direction;
  if (pair.shared == 0) return leastOf(pair.a, n, x) - mostOf(pair.b, n, x);
  const double at = n.dot(x[pair.a[2]]);
  if (pair.shared == 1) {
    return std::min({n.dot(x[pair.a[0]]) - at, n.dot(x[pair.a[1]]) - at, at - n.dot(x[pair.b[0]]),
                     at - n.dot(x[pair.b[1]])});
  }
  // The corners are on both sides of the common edge, however it tilts against the normal: by less
  // than a quarter of their distance, if they lie beside the edge or up to its length beyond.
  const double other = n.dot(x[pair.a[1]]);
  const double apart = std::min(n.dot(x[pair.a[0]]) - std::max(at, other),
                                std::min(at, other) - n.dot(x[pair.b[0]]));
  return apart - kMostTilt * std::abs(at - other);
}

/// The distance of a pair along its direction at the end of the substep [m]; 0 if it is not apart
/// at the start.
double separationWithin(const FacePair& pair, const SubstepMotion& motion) {
  const double apart = separationOf(pair, motion.end);
  return apart > kApart && separationOf(pair, motion.start) > 0.0 ? apart : 0.0;
}

/// The axis along which two faces without a common corner are farthest apart.
Vec3 bestAxis(const FacePair& pair, const std::vector<Vec3>& x) {
  const Vec3 lowA = x[pair.a[0]].cwiseMin(x[pair.a[1]]).cwiseMin(x[pair.a[2]]);
  const Vec3 highA = x[pair.a[0]].cwiseMax(x[pair.a[1]]).cwiseMax(x[pair.a[2]]);
  const Vec3 lowB = x[pair.b[0]].cwiseMin(x[pair.b[1]]).cwiseMin(x[pair.b[2]]);
  const Vec3 highB = x[pair.b[0]].cwiseMax(x[pair.b[1]]).cwiseMax(x[pair.b[2]]);
  int above = 0;
  int below = 0;
  const double gapAbove = (lowA - highB).maxCoeff(&above);
  const double gapBelow = (lowB - highA).maxCoeff(&below);
  return gapAbove >= gapBelow ? Vec3::Unit(above) : Vec3(-Vec3::Unit(below));
}

/// Tries the axes, from the middle of one face to that of the other, and the normals of both, which
/// cost less than closest points. \return as `separationWithin`.
double tryDirections(FacePair& pair, const SubstepMotion& motion) {
  const std::vector<Vec3>& x = motion.end;
  pair.direction = bestAxis(pair, x);
  double apart = separationWithin(pair, motion);
  if (apart > kApart) return apart;
  const auto middle = [&](const Face& f) -> Vec3 { return x[f[0]] + x[f[1]] + x[f[2]]; };
  const Vec3 between = middle(pair.a) - middle(pair.b);
  for (const Vec3& candidate : {Vec3(between.normalized()), normalTowards(between, pair.a, x),
                                normalTowards(between, pair.b, x)}) {
    pair.direction = candidate;
    apart = separationWithin(pair, motion);
    if (apart > kApart) break;
  }
  return apart;
}

/// Tries the direction from the middle of one face to that of another, both seen from their common
/// corner. \return as `separationWithin`.
double tryFromVertex(FacePair& pair, const SubstepMotion& motion) {
  const std::vector<Vec3>& x = motion.end;
  const Vec3& at = x[pair.a[2]];
  const Vec3 a = x[pair.a[0]] + x[pair.a[1]] - 2.0 * at;
  const Vec3 b = x[pair.b[0]] + x[pair.b[1]] - 2.0 * at;
  pair.direction = (a.normalized() - b.normalized()).normalized();
  return separationWithin(pair, motion);
}

/// The most that the separation loses, over what PairWatch counts: the travel of two faces without
/// a common corner, or the changes of edges of others. A common edge tilts by no more than the
/// lesser of these, and the corners beyond it approach it by the larger one.
double rateOf(const FacePair& pair) { return pair.shared < 2 ? 1.0 : 0.5 * (1.0 + kMostTilt); }

/// Tells whether a plane that turns from one direction to another keeps the pair apart. With a
/// normal n(t) = n0 + t (n1 - n0) and a vertex at x(t) = x0 + t (x1 - x0), relative to a point that
/// moves alike, n(t).x(t) = (1 - t) q0 + t q1 - t (1 - t) d with d = (n1 - n0).(x1 - x0), which is
/// positive if q0 and q1 are and d < (sqrt(q0) + sqrt(q1))^2.
bool staysApart(const FacePair& pair, const Vec3& n0, const Vec3& n1, SubstepMotion motion) {
  const Vec3 turn = n1 - n0;
  const auto passes = [](double q0, double q1, double d) {
    if (!(q0 > 0.0) || !(q1 > 0.0)) return false;
    const double root = std::sqrt(q0) + std::sqrt(q1);
    return d < 0.99 * root * root;
  };
  const std::vector<Vec3>& x0 = motion.start;
  const std::vector<Vec3>& x1 = motion.end;
  Vec3 common = x1[pair.a[2]] - x0[pair.a[2]];
  double a0 = n0.dot(x0[pair.a[2]]);  // offset of the plane at the start, for each side
  double a1 = n1.dot(x1[pair.a[2]]);
  double tilt = 0.0;
  if (pair.shared == 0) {
    a0 = 0.5 * (leastOf(pair.a, n0, x0) + mostOf(pair.b, n0, x0));
    a1 = 0.5 * (leastOf(pair.a, n1, x1) + mostOf(pair.b, n1, x1));
    common = 0.5 * (common + x1[pair.b[2]] - x0[pair.b[2]]);
  } else if (pair.shared == 2) {
    const Vec3 edge = x1[pair.a[1]] - x0[pair.a[1]] - common;
    tilt = kMostTilt * std::abs(turn.dot(edge));
  }
  for (int k = 0; k < 3 - pair.shared; ++k) {
    for (const double side : {1.0, -1.0}) {
      const VertexId v = side > 0.0 ? pair.a[k] : pair.b[k];
      const double d = side * turn.dot(x1[v] - x0[v] - common) + tilt;
      if (!passes(side * (n0.dot(x0[v]) - a0), side * (n1.dot(x1[v]) - a1), d)) return false;
    }
  }
  return true;
}

}  // namespace

FacePair::FacePair(const Face& first, const Face& second) : a(first), b(second) {
  shared = sortShared(a, b);
}

bool areApart(const Face& a, const Face& b, const std::vector<Vec3>& x) {
  return bestDirection(FacePair(a, b), x).distance > 0.0;
}

SeparatingDirection bestDirection(const FacePair& pair, const std::vector<Vec3>& x) {
  if (pair.shared == 0) return separate(cornersOf(pair.a, x), cornersOf(pair.b, x));
  const Vec3& at = x[pair.a[2]];
  if (pair.shared == 2)
    return separateHinge(x[pair.a[1]] - at, x[pair.a[0]] - at, x[pair.b[0]] - at);
  return separateAtVertex({x[pair.a[0]] - at, x[pair.a[1]] - at},
                          {x[pair.b[0]] - at, x[pair.b[1]] - at});
}

double slackOf(FacePair& pair, const SubstepMotion& motion) {
  const auto slackIn = [&](double apart) { return (apart - kApart) / rateOf(pair); };
  double apart = pair.direction.isZero() ? 0.0 : separationWithin(pair, motion);
  if (apart > kApart) return slackIn(apart);
  if (pair.shared < 2) {
    apart = pair.shared == 0 ? tryDirections(pair, motion) : tryFromVertex(pair, motion);
    if (apart > kApart) return slackIn(apart);
  }
  const SeparatingDirection before = bestDirection(pair, motion.start);
  pair.direction = before.direction;
  if (!(before.distance > 0.0)) return 0.0;
  apart = separationWithin(pair, motion);
  if (apart > kApart) return slackIn(apart);
  const SeparatingDirection after = bestDirection(pair, motion.end);
  if (after.distance <= kApart) return 0.0;
  if (!staysApart(pair, before.direction, after.direction, motion)) return 0.0;
  pair.direction = after.direction;
  return slackIn(after.distance);
}

Vec3 endDirection(FacePair pair, const Vec3& before, const std::vector<Vec3>& end) {
  const SeparatingDirection best = bestDirection(pair, end);
  if (pair.shared == 2) {
    return best.direction.dot(before) < 0.0 ? Vec3(-best.direction) : best.direction;
  }
  if (best.distance > 0.0 && best.direction.dot(before) > 0.0) return best.direction;
  const Vec3 a = normalTowards(before, pair.a, end);
  const Vec3 b = normalTowards(before, pair.b, end);
  Vec3 chosen = before;
  pair.direction = before;
  double most = separationOf(pair, end);
  for (const Vec3& candidate : {a, b, Vec3((a + b).normalized())}) {
    pair.direction = candidate;
    const double apart = separationOf(pair, end);
    if (!(apart > most)) continue;
    most = apart;
    chosen = candidate;
  }
  return chosen;
}

}  // namespace cloth_sim
