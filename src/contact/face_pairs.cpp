#include "face_pairs.h"

#include <algorithm>
#include <cmath>

#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Distance that counts as apart [m]: far above round-off, far below the thickness of cloth.
constexpr double kApart = 1e-8;
/// Fraction of the distance of two faces that each side keeps from the plane between them.
constexpr double kKeep = 0.05;

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

double leastOf(const Face& face, const Vec3& n, const std::vector<Vec3>& x) {
  return std::min({n.dot(x[face[0]]), n.dot(x[face[1]]), n.dot(x[face[2]])});
}
double mostOf(const Face& face, const Vec3& n, const std::vector<Vec3>& x) {
  return std::max({n.dot(x[face[0]]), n.dot(x[face[1]]), n.dot(x[face[2]])});
}

/// Shortens the motion of a vertex to the fraction `t` of what it is.
void moveBack(VertexId v, double t, SubstepMotion motion, std::vector<std::uint8_t>& truncated) {
  if (!(t < 1.0)) return;
  motion.end[v] = motion.start[v] + std::max(0.0, t) * (motion.end[v] - motion.start[v]);
  truncated[v] = 1;
}

/// Shortens the motion of a vertex so that it ends at least at `bound` along `n`, or where it starts
/// if that is less [m].
void keepBeyond(VertexId v, const Vec3& n, double bound, SubstepMotion motion,
                std::vector<std::uint8_t>& truncated) {
  const double from = n.dot(motion.start[v]);
  const double to = n.dot(motion.end[v]);
  if (to < bound && to < from) moveBack(v, (from - bound) / (from - to), motion, truncated);
}

/// Shortens the motion of a vertex to `length` [m].
void limit(VertexId v, double length, SubstepMotion motion, std::vector<std::uint8_t>& truncated) {
  const double moved = (motion.end[v] - motion.start[v]).norm();
  if (moved > length) moveBack(v, length / moved, motion, truncated);
}

}  // namespace

void FacePairs::assign(const std::vector<FaceIds>& near, const std::vector<Face>& faces,
                       double least) {
  least_ = least;
  pairs_.clear();
  travel_ = 0.0;
  for (const FaceIds& ids : near) {
    Pair pair;
    pair.a = faces[ids.first];
    pair.b = faces[ids.second];
    pair.shared = sortShared(pair.a, pair.b);
    pairs_.push_back(pair);
  }
}

bool FacePairs::hasTruncated(const Pair& pair, const std::vector<std::uint8_t>& truncated) {
  const auto isTruncated = [&](VertexId v) { return truncated[v] != 0; };
  return std::any_of(pair.a.begin(), pair.a.end(), isTruncated) ||
         std::any_of(pair.b.begin(), pair.b.end(), isTruncated);
}

/// How far face a is beyond face b along the direction of the pair [m].
double FacePairs::separationOf(const Pair& pair, const std::vector<Vec3>& x) {
  const Vec3& n = pair.direction;
  if (pair.shared == 0) return leastOf(pair.a, n, x) - mostOf(pair.b, n, x);
  const double at = n.dot(x[pair.a[2]]);
  return std::min({n.dot(x[pair.a[0]]) - at, n.dot(x[pair.a[1]]) - at, at - n.dot(x[pair.b[0]]),
                   at - n.dot(x[pair.b[1]])});
}

/// The least distance of a corner of two faces with a common edge from the other face [m].
double FacePairs::hingeGap(const Pair& pair, const std::vector<Vec3>& x) {
  const auto distance = [&](VertexId v, const Face& face) {
    const Corners corners = cornersOf(face, x);
    const std::array<double, 3> w = closestOnTriangle(x[v], corners);
    return (x[v] - w[0] * corners[0] - w[1] * corners[1] - w[2] * corners[2]).norm();
  };
  return std::min(distance(pair.a[0], pair.b), distance(pair.b[0], pair.a));
}

SeparatingDirection FacePairs::bestDirection(const Pair& pair, const std::vector<Vec3>& x) {
  if (pair.shared == 0) return separate(cornersOf(pair.a, x), cornersOf(pair.b, x));
  const Vec3& at = x[pair.a[2]];
  if (pair.shared == 2) return separateHinge(x[pair.a[1]] - at, x[pair.a[0]] - at, x[pair.b[0]] - at);
  return separateAtVertex({x[pair.a[0]] - at, x[pair.a[1]] - at},
                          {x[pair.b[0]] - at, x[pair.b[1]] - at});
}

/// Whether the pair stays apart in the substep; finds another direction where that helps.
bool FacePairs::isProven(Pair& pair, SubstepMotion motion) const {
  if (pair.shared == 2) {
    // Two faces with a common edge meet only where a corner reaches the other face.
    const double gap = hingeGap(pair, motion.start);
    double moved = 0.0;
    const Vec3 carried = motion.end[pair.a[2]] - motion.start[pair.a[2]];
    for (const VertexId v : {pair.a[0], pair.a[1], pair.b[0]}) {
      moved = std::max(moved, (motion.end[v] - motion.start[v] - carried).norm());
    }
    pair.due = travel_ + gap - kApart - 2.0 * moved;
    return pair.due > travel_;
  }
  if (!pair.direction.isZero()) {
    const double apart = separationOf(pair, motion.end);
    if (apart >= kApart && separationOf(pair, motion.start) > 0.0) {
      pair.due = travel_ + apart - kApart;
      return true;
    }
  }
  return findDirection(pair, motion);
}

/// Finds a direction that separates the pair at both ends: from either end.
/// \return whether there is one; if not, the direction is the best one at the start.
bool FacePairs::findDirection(Pair& pair, SubstepMotion motion) const {
  for (const std::vector<Vec3>* const x :
       {static_cast<const std::vector<Vec3>*>(&motion.end), &motion.start}) {
    pair.direction = bestDirection(pair, *x).direction;
    if (pair.direction.isZero()) continue;
    const double apart = separationOf(pair, motion.end);
    if (apart < kApart || separationOf(pair, motion.start) <= 0.0) continue;
    pair.due = travel_ + apart - kApart;
    return true;
  }
  return false;
}

/// Shortens the motion of the vertices of a pair that would not stay apart.
void FacePairs::shorten(Pair& pair, SubstepMotion motion, std::vector<std::uint8_t>& truncated,
                        TruncationCount& count) const {
  pair.isFixed = true;
  pair.due = 0.0;
  const SeparatingDirection before = bestDirection(pair, motion.start);
  pair.direction = before.direction;
  if (!(before.distance > 0.0)) {
    ++count.unproven;
    for (const VertexId v : pair.a) limit(v, 0.0, motion, truncated);
    for (const VertexId v : pair.b) limit(v, 0.0, motion, truncated);
  } else if (pair.shared > 0) {
    shortenAtShared(pair, before.distance, motion, truncated);
  } else {
    shortenApart(pair, motion, truncated);
  }
}

/// Lets shared corners move little along the direction of the pair, and the others approach them by
/// less than half of their distance.
/// \param apart  least distance of the other corners from the shared ones along the direction [m].
void FacePairs::shortenAtShared(const Pair& pair, double apart, SubstepMotion motion,
                                std::vector<std::uint8_t>& truncated) const {
  const Vec3& n = pair.direction;
  const bool mayApproach = apart > least_;
  const double slack = mayApproach ? 0.1 * apart : 0.0;
  const double keep = mayApproach ? 0.6 * apart : apart;
  const double at = n.dot(motion.start[pair.a[2]]);
  const int others = 3 - pair.shared;
  for (int k = others; k < 3; ++k) {
    const VertexId v = pair.a[k];
    const double moved = std::abs(n.dot(motion.end[v] - motion.start[v]));
    if (moved > slack) moveBack(v, slack / moved, motion, truncated);
  }
  for (int k = 0; k < others; ++k) {
    keepBeyond(pair.a[k], n, at + keep, motion, truncated);
    keepBeyond(pair.b[k], -n, keep - at, motion, truncated);
  }
}

/// Keeps two faces without a common corner on their sides of a plane between them. The side that
/// approaches more gets more of the distance.
void FacePairs::shortenApart(const Pair& pair, SubstepMotion motion,
                             std::vector<std::uint8_t>& truncated) const {
  const Vec3& n = pair.direction;
  const double high = leastOf(pair.a, n, motion.start);
  const double low = mostOf(pair.b, n, motion.start);
  const double keep = std::max(kKeep * (high - low), 0.5 * std::min(high - low, least_));
  const double approachA = std::max(0.0, high - leastOf(pair.a, n, motion.end));
  const double approachB = std::max(0.0, mostOf(pair.b, n, motion.end) - low);
  const double all = approachA + approachB;
  const double plane = low + keep + (high - low - 2.0 * keep) * (all > 0.0 ? approachB / all : 0.5);
  for (const VertexId v : pair.a) keepBeyond(v, n, plane + keep, motion, truncated);
  for (const VertexId v : pair.b) keepBeyond(v, -n, keep - plane, motion, truncated);
}

/// Lists the pairs that do not stay apart in the substep.
/// \param isFirst  whether no motion has been shortened yet; otherwise only pairs with such a vertex
///                 can fail, and those whose own motion was shortened do not.
void FacePairs::findFailing(bool isFirst, SubstepMotion motion,
                            const std::vector<std::uint8_t>& truncated) {
  constexpr std::int32_t kGrain = 512;
  fails_.resize(pairs_.size());
  parallelFor(static_cast<std::int32_t>(pairs_.size()), kGrain,
              [&](std::int32_t first, std::int32_t last) {
                for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last);
                     ++k) {
                  Pair& pair = pairs_[k];
                  if (isFirst) pair.isFixed = false;
                  const bool isDue = isFirst ? travel_ >= pair.due
                                             : !pair.isFixed && hasTruncated(pair, truncated);
                  fails_[k] = isDue && !isProven(pair, motion) ? 1 : 0;
                }
              });
  failing_.clear();
  for (std::size_t k = 0; k < fails_.size(); ++k) {
    if (fails_[k] != 0) failing_.push_back(static_cast<std::uint32_t>(k));
  }
}

TruncationCount FacePairs::keepApart(SubstepMotion motion, std::vector<std::uint8_t>& truncated) {
  TruncationCount count;
  if (pairs_.empty()) return count;
  double farthest = 0.0;
  for (std::size_t v = 0; v < motion.start.size(); ++v) {
    farthest = std::max(farthest, (motion.end[v] - motion.start[v]).squaredNorm());
  }
  travel_ += 2.0 * std::sqrt(farthest);
  constexpr int kMostPasses = 60;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    findFailing(pass == 0, motion, truncated);
    if (failing_.empty()) break;
    for (const std::uint32_t k : failing_) shorten(pairs_[k], motion, truncated, count);
  }
  if (!failing_.empty()) {
    // Too many in a row: everything stays where it was.
    for (std::size_t v = 0; v < motion.start.size(); ++v) {
      limit(static_cast<VertexId>(v), 0.0, motion, truncated);
    }
  }
  count.vertices = static_cast<int>(std::count(truncated.begin(), truncated.end(), 1));
  return count;
}

}  // namespace cloth_sim
