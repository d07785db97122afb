#include "truncation.h"

#include <algorithm>

namespace cloth_sim {
namespace {

/// Distance to which sliding parts two faces that are nearer [m], and from which on faces with a
/// common corner stay where they are if it cannot: they would lose a part of what is left in each
/// substep, until round-off hides the direction between them.
constexpr double kLeast = 1e-7;
/// Least share of their distance that two faces keep in a substep.
constexpr double kKeepSliding = 0.1;
/// Fraction of the distance of two faces that each side keeps from the plane between them.
constexpr double kKeep = 0.05;

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

/// The share of b in moving two faces apart: by their masses, and none if its motion is prescribed.
double shareOf(const FacePair& pair, const std::vector<double>& mass) {
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

/// Lets shared corners move little along the direction of the pair, and the others approach them by
/// less than half of their distance.
/// \param apart  least distance of the other corners from the shared ones along the direction [m].
void shortenAtShared(const FacePair& pair, double apart, const Truncation& now) {
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
void shortenApart(const FacePair& pair, double least, const Truncation& now) {
  const Vec3& n = pair.direction;
  const double high = leastOf(pair.a, n, now.motion.start);
  const double low = mostOf(pair.b, n, now.motion.start);
  const double keep = std::max(kKeep * (high - low), 0.5 * std::min(high - low, least));
  const double approachA = std::max(0.0, high - leastOf(pair.a, n, now.motion.end));
  const double approachB = std::max(0.0, mostOf(pair.b, n, now.motion.end) - low);
  const double all = approachA + approachB;
  const double plane = low + keep + (high - low - 2.0 * keep) * (all > 0.0 ? approachB / all : 0.5);
  for (const VertexId v : pair.a) keepBeyond(v, n, plane + keep, now);
  for (const VertexId v : pair.b) keepBeyond(v, -n, keep - plane, now);
}

}  // namespace

void moveBack(VertexId v, double t, const Truncation& now) {
  if (!(t < 1.0)) return;
  const SubstepMotion& motion = now.motion;
  motion.end[v] = motion.start[v] + std::max(0.0, t) * (motion.end[v] - motion.start[v]);
  now.truncated[v] = now.pass;
}

bool slide(const FacePair& pair, double least, const Truncation& now) {
  const SeparatingDirection before = bestDirection(pair, now.motion.start);
  if (!(before.distance > 0.0)) return false;
  const std::vector<Vec3>& end = now.motion.end;
  const Vec3 n = endDirection(pair, before.direction, end);
  const double keep =
      std::max({kKeepSliding * before.distance, std::min(before.distance, least), kLeast});
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

bool shorten(FacePair& pair, double least, const Truncation& now) {
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
    shortenApart(pair, least, now);
  }
  return true;
}

}  // namespace cloth_sim
