#include "face_pairs.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Distance to which sliding parts two faces that are nearer [m], and from which on faces with a
/// common corner stay where they are if it cannot: they would lose a part of what is left in each
/// substep, until round-off hides the direction between them.
constexpr double kLeast = 1e-7;
/// Factor by which the corners of two faces with a common edge are farther apart than the edge is
/// tilted.
constexpr double kMostTilt = 4.0;
/// Least share of their distance that two faces keep in a substep.
constexpr double kKeepSliding = 0.1;
/// Fraction of the distance of two faces that each side keeps from the plane between them.
constexpr double kKeep = 0.05;

/// Passes of the certificate: at first only vertices slide that nobody holds, then moving held ones
/// as well; after that motion is shortened.
constexpr int kPassesOfFree = 12;
constexpr int kPassesOfSliding = 20;
constexpr int kPassesInAll = 60;

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

/// The unit normal of a face on the side of `direction`.
Vec3 normalTowards(const Vec3& direction, const Face& face, const std::vector<Vec3>& x) {
  const Vec3 n = (x[face[1]] - x[face[0]]).cross(x[face[2]] - x[face[0]]).normalized();
  return n.dot(direction) < 0.0 ? Vec3(-n) : n;
}

/// Shortens the motion of a vertex to the fraction `t` of what it is.
void moveBack(VertexId v, double t, const Truncation& now) {
  if (!(t < 1.0)) return;
  const SubstepMotion& motion = now.motion;
  motion.end[v] = motion.start[v] + std::max(0.0, t) * (motion.end[v] - motion.start[v]);
  now.truncated[v] = now.pass;
}

/// Makes a vertex end at least at `bound` along `n`, or where it starts if that is less [m], by
/// shortening its motion.
void keepBeyond(VertexId v, const Vec3& n, double bound, const Truncation& now) {
  const double from = n.dot(now.motion.start[v]);
  const double to = n.dot(now.motion.end[v]);
  if (to < bound && to < from) moveBack(v, (from - bound) / (from - to), now);
}

/// Tells whether a vertex may leave its way by some distance [m]: first those that nobody holds,
/// then held ones as well, each time by no more than they move, so that they need not stop.
bool maySlide(VertexId v, double distance, const Truncation& now) {
  const SubstepMotion& motion = now.motion;
  if (motion.mass[v] > 0.0) return true;
  return now.pass > kPassesOfFree &&
         distance * distance <= (motion.end[v] - motion.start[v]).squaredNorm();
}

void slideBy(VertexId v, const Vec3& way, const Truncation& now) {
  now.motion.end[v] += way;
  now.truncated[v] = now.pass;
}

/// Makes a vertex end at least at `bound` along `n` [m], if it may slide so far. \return how far it
/// would still have to [m].
double slideBeyond(VertexId v, const Vec3& n, double bound, const Truncation& now) {
  const double missing = bound - n.dot(now.motion.end[v]);
  if (!(missing > 0.0)) return 0.0;
  if (!maySlide(v, missing, now)) return missing;
  slideBy(v, missing * n, now);
  return 0.0;
}

/// Moves a free corner that two faces share where another corner would have to give way and is
/// held: otherwise a clamp may never pull cloth out of a fold.
void slideShared(VertexId v, const Vec3& way, const Truncation& now) {
  if (way.isZero(0.0) || now.motion.mass[v] == 0.0) return;
  slideBy(v, way, now);
}

}  // namespace

void FacePairs::assign(const std::vector<FaceIds>& near, const std::vector<Face>& faces,
                       double least) {
  least_ = least;
  clear();
  watch_.begin(faces);
  append(near, 0);
}

void FacePairs::clear() {
  watch_.clear();
  pairs_.clear();
  placeOf_.clear();
  indexed_ = 0;
}

void FacePairs::append(const std::vector<FaceIds>& near, std::size_t first) {
  watch_.append(near, first);
  placeOf_.resize(watch_.count(), kNone);
}

/// The corners and the direction of a pair, which are listed from the first time on that somebody
/// asks.
FacePairs::Pair& FacePairs::pairAt(std::size_t k) {
  if (placeOf_[k] == kNone) {
    placeOf_[k] = static_cast<std::int32_t>(pairs_.size());
    const FaceIds& ids = watch_.ids(k);
    pairs_.push_back(pairOf(watch_.faces()[ids.first], watch_.faces()[ids.second]));
  }
  return pairs_[placeOf_[k]];
}

FacePairs::Pair FacePairs::pairOf(const Face& a, const Face& b) {
  Pair pair;
  pair.a = a;
  pair.b = b;
  pair.shared = sortShared(pair.a, pair.b);
  return pair;
}

bool FacePairs::areApart(const Face& a, const Face& b, const std::vector<Vec3>& x) {
  return bestDirection(pairOf(a, b), x).distance > 0.0;
}

/// Returns the distance of face a beyond face b along the direction of the pair [m].
double FacePairs::separationOf(const Pair& pair, const std::vector<Vec3>& x) {
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

SeparatingDirection FacePairs::bestDirection(const Pair& pair, const std::vector<Vec3>& x) {
  if (pair.shared == 0) return separate(cornersOf(pair.a, x), cornersOf(pair.b, x));
  const Vec3& at = x[pair.a[2]];
  if (pair.shared == 2)
    return separateHinge(x[pair.a[1]] - at, x[pair.a[0]] - at, x[pair.b[0]] - at);
  return separateAtVertex({x[pair.a[0]] - at, x[pair.a[1]] - at},
                          {x[pair.b[0]] - at, x[pair.b[1]] - at});
}

/// Finds how far the faces of a pair may travel until they may touch, if they stay apart in the
/// substep; finds other directions where that helps. \return 0 if they may not [m].
double FacePairs::slackOf(Pair& pair, const SubstepMotion& motion) {
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

/// Tells whether a plane that turns from one direction to another keeps the pair apart. With a
/// normal n(t) = n0 + t (n1 - n0) and a vertex at x(t) = x0 + t (x1 - x0), relative to a point that
/// moves alike, n(t).x(t) = (1 - t) q0 + t q1 - t (1 - t) d with d = (n1 - n0).(x1 - x0), which is
/// positive if q0 and q1 are and d < (sqrt(q0) + sqrt(q1))^2.
bool FacePairs::staysApart(const Pair& pair, const Vec3& n0, const Vec3& n1, SubstepMotion motion) {
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

/// The most that the separation loses, over what PairWatch counts: the travel of two faces without
/// a common corner, or the changes of edges of others. A common edge tilts by no more than the
/// lesser of these, and the corners beyond it approach it by the larger one.
double FacePairs::rateOf(const Pair& pair) {
  return pair.shared < 2 ? 1.0 : 0.5 * (1.0 + kMostTilt);
}

/// A direction for the end of the substep, near `before`, if the pair overlaps there: the one with
/// the least overlap of some.
Vec3 FacePairs::endDirection(Pair pair, const Vec3& before, const std::vector<Vec3>& end) {
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

/// The axis along which two faces without a common corner are farthest apart.
Vec3 FacePairs::bestAxis(const Pair& pair, const std::vector<Vec3>& x) {
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
double FacePairs::tryDirections(Pair& pair, const SubstepMotion& motion) {
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
double FacePairs::tryFromVertex(Pair& pair, const SubstepMotion& motion) {
  const std::vector<Vec3>& x = motion.end;
  const Vec3& at = x[pair.a[2]];
  const Vec3 a = x[pair.a[0]] + x[pair.a[1]] - 2.0 * at;
  const Vec3 b = x[pair.b[0]] + x[pair.b[1]] - 2.0 * at;
  pair.direction = (a.normalized() - b.normalized()).normalized();
  return separationWithin(pair, motion);
}

/// The distance of a pair along its direction at the end of the substep [m]; 0 if it is not apart
/// at the start.
double FacePairs::separationWithin(const Pair& pair, const SubstepMotion& motion) {
  const double apart = separationOf(pair, motion.end);
  return apart > kApart && separationOf(pair, motion.start) > 0.0 ? apart : 0.0;
}

/// Moves the vertices of a pair that would not stay apart to where it does, along its direction;
/// they keep the motion that they have in common. Other pairs may fail then, or this one again.
/// \return whether it was apart at the start.
bool FacePairs::slide(Pair& pair, const Truncation& now) const {
  const SeparatingDirection before = bestDirection(pair, now.motion.start);
  if (!(before.distance > 0.0)) return false;
  const std::vector<Vec3>& end = now.motion.end;
  const Vec3 n = endDirection(pair, before.direction, end);
  const double keep =
      std::max({kKeepSliding * before.distance, std::min(before.distance, least_), kLeast});
  if (pair.shared == 0) {
    const double high = leastOf(pair.a, n, end);
    const double low = mostOf(pair.b, n, end);
    const double push = keep - (high - low);
    const double share = shareOf(pair, now.motion.mass);
    for (const VertexId v : pair.a) slideBeyond(v, n, high + (1.0 - share) * push, now);
    for (const VertexId v : pair.b) slideBeyond(v, -n, share * push - low, now);
    return true;
  }
  double top = n.dot(end[pair.a[2]]);  // of the shared corners
  double bottom = top;
  if (pair.shared == 2) {
    const double other = n.dot(end[pair.a[1]]);
    const double tilt = std::abs(top - other);
    top = std::max(top, other) + tilt;
    bottom = std::min(bottom, other) - tilt;
  }
  for (int k = 0; k < 3 - pair.shared; ++k) {
    const double missingA = slideBeyond(pair.a[k], n, top + keep, now);
    const double missingB = slideBeyond(pair.b[k], -n, keep - bottom, now);
    if (pair.shared == 1) slideShared(pair.a[2], (missingB - missingA) * n, now);
  }
  return true;
}

/// The share of b in moving two faces apart: by their masses, and none if its motion is prescribed.
double FacePairs::shareOf(const Pair& pair, const std::vector<double>& mass) {
  const auto massOf = [&](const Face& face) {
    double sum = 0.0;
    for (const VertexId v : face) {
      if (mass[v] == 0.0) return 0.0;
      sum += mass[v];
    }
    return sum;
  };
  const double a = massOf(pair.a);
  const double b = massOf(pair.b);
  if (a == 0.0 && b == 0.0) return 0.5;
  if (a == 0.0) return 1.0;
  return b == 0.0 ? 0.0 : a / (a + b);
}

/// Shortens the motion of the vertices of a pair that would not stay apart. It stays apart from
/// then on in this substep, however motion is shortened further. \return whether it was apart at
/// the start; if not, or hardly so at a common corner, its vertices stay.
bool FacePairs::shorten(Pair& pair, const Truncation& now) const {
  const SeparatingDirection before = bestDirection(pair, now.motion.start);
  pair.direction = before.direction;
  const bool isApart = before.distance > 0.0;
  if (!isApart || (pair.shared > 0 && before.distance < kLeast)) {
    for (const Face* face : {&pair.a, &pair.b}) {
      for (const VertexId v : *face) moveBack(v, 0.0, now);
    }
    return isApart;
  }
  if (pair.shared > 0) {
    shortenAtShared(pair, before.distance, now);
  } else {
    shortenApart(pair, now);
  }
  return true;
}

/// Lets shared corners move little along the direction of the pair, and the others approach them by
/// less than half of their distance.
/// \param apart  least distance of the other corners from the shared ones along the direction [m].
void FacePairs::shortenAtShared(const Pair& pair, double apart, const Truncation& now) {
  const Vec3& n = pair.direction;
  const double slack = 0.04 * apart;
  const double keep = 0.6 * apart;
  const double at = n.dot(now.motion.start[pair.a[2]]);
  const int others = 3 - pair.shared;
  for (int k = others; k < 3; ++k) {
    keepBeyond(pair.a[k], n, at - slack, now);
    keepBeyond(pair.a[k], -n, -at - slack, now);
  }
  for (int k = 0; k < others; ++k) {
    keepBeyond(pair.a[k], n, at + keep, now);
    keepBeyond(pair.b[k], -n, keep - at, now);
  }
}

/// Keeps two faces without a common corner on their sides of a plane between them. The side that
/// approaches more gets more of the distance.
void FacePairs::shortenApart(const Pair& pair, const Truncation& now) const {
  const Vec3& n = pair.direction;
  const double high = leastOf(pair.a, n, now.motion.start);
  const double low = mostOf(pair.b, n, now.motion.start);
  const double keep = std::max(kKeep * (high - low), 0.5 * std::min(high - low, least_));
  const double approachA = std::max(0.0, high - leastOf(pair.a, n, now.motion.end));
  const double approachB = std::max(0.0, mostOf(pair.b, n, now.motion.end) - low);
  const double all = approachA + approachB;
  const double plane = low + keep + (high - low - 2.0 * keep) * (all > 0.0 ? approachB / all : 0.5);
  for (const VertexId v : pair.a) keepBeyond(v, n, plane + keep, now);
  for (const VertexId v : pair.b) keepBeyond(v, -n, keep - plane, now);
}

/// Lists the pairs of each face.
void FacePairs::indexPairs() {
  indexed_ = watch_.count();
  pairsStart_.assign(watch_.faces().size() + 1, 0);
  const auto facesOf = [this](std::size_t k) {
    return std::array<FaceId, 2>{watch_.ids(k).first, watch_.ids(k).second};
  };
  for (std::size_t k = 0; k < indexed_; ++k) {
    for (const FaceId f : facesOf(k)) ++pairsStart_[f];
  }
  std::partial_sum(pairsStart_.begin(), pairsStart_.end(), pairsStart_.begin());
  pairsOf_.resize(2 * indexed_);
  for (std::size_t k = indexed_; k-- > 0;) {
    for (const FaceId f : facesOf(k)) pairsOf_[--pairsStart_[f]] = static_cast<std::uint32_t>(k);
  }
}

/// Lists the pairs that have to be looked at again after a pass that changed motion: those that
/// failed, or that have a vertex that was moved; unless their own motion was scaled.
void FacePairs::listAgain(const Truncation& last) {
  if (indexed_ != watch_.count()) indexPairs();
  isListed_.resize(watch_.count(), 0);
  listed_.clear();
  const auto list = [this](std::uint32_t k) {
    if (isListed_[k] != 0) return;
    isListed_[k] = 1;
    listed_.push_back(k);
  };
  const auto isMoved = [&](VertexId v) { return last.truncated[v] == last.pass; };
  for (const FaceId f : watch_.paired()) {
    const Face& face = watch_.faces()[f];
    if (!isMoved(face[0]) && !isMoved(face[1]) && !isMoved(face[2])) continue;
    for (auto at = pairsStart_[f]; at < pairsStart_[f + 1]; ++at) list(pairsOf_[at]);
  }
  for (const std::uint32_t k : failing_) list(k);
  for (const std::uint32_t k : listed_) isListed_[k] = 0;
  const auto isFixed = [this](std::uint32_t k) {
    return placeOf_[k] != kNone && pairs_[placeOf_[k]].isFixed;
  };
  listed_.erase(std::remove_if(listed_.begin(), listed_.end(), isFixed), listed_.end());
  std::sort(listed_.begin(), listed_.end());
}

/// Looks at the pairs that are listed, and lists those that do not stay apart in the substep.
void FacePairs::findFailing(const SubstepMotion& motion) {
  constexpr std::int32_t kGrain = 256;
  for (const std::uint32_t k : listed_) pairAt(k);
  slack_.resize(listed_.size());
  parallelFor(static_cast<std::int32_t>(listed_.size()), kGrain,
              [&](std::int32_t first, std::int32_t last) {
                for (std::int32_t n = first; n < last; ++n) {
                  slack_[n] = slackOf(pairs_[placeOf_[listed_[n]]], motion);
                }
              });
  failing_.clear();
  for (std::size_t n = 0; n < listed_.size(); ++n) {
    watch_.setDue(listed_[n], slack_[n]);
    if (slack_[n] == 0.0) failing_.push_back(listed_[n]);
  }
}

PairOutcome FacePairs::keepApart(Truncation now) {
  PairOutcome outcome;
  if (watch_.count() == 0) return outcome;
  const SubstepMotion& motion = now.motion;
  watch_.follow(motion);
  watch_.listDue(listed_);
  for (const std::uint32_t k : listed_) pairAt(k).isFixed = false;
  for (int pass = 0; pass < kPassesInAll; ++pass) {
    if (pass > 0) listAgain(now);
    now.pass = static_cast<std::uint8_t>(pass + 1);
    findFailing(motion);
    if (failing_.empty()) return outcome;
    outcome.changed = true;
    for (const std::uint32_t k : failing_) {
      Pair& pair = pairAt(k);
      const bool areSliding = pass < kPassesOfSliding;
      if (areSliding && slide(pair, now)) continue;
      if (!shorten(pair, now)) ++outcome.unproven;
      // Where others may slide, what stays now may be moved again.
      pair.isFixed = !areSliding;
    }
  }
  stop(now);
  return outcome;
}

void FacePairs::stop(const Truncation& now) {
  watch_.setAllDue();
  for (const VertexId v : now.motion.vertices) {
    if (now.motion.end[v] != now.motion.start[v]) moveBack(v, 0.0, now);
  }
}

}  // namespace cloth_sim
