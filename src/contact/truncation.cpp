#include "truncation.h"

#include <algorithm>
#include <array>

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
  const double to = n.dot(now.motion.end[v] - now.common);
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

/// Makes a vertex end at least at `bound` along `n` [m], if it may slide so far.
void slideBeyond(VertexId v, const Vec3& n, double bound, const Truncation& now) {
  const double missing = bound - n.dot(now.motion.end[v]);
  if (missing > 0.0 && maySlide(v, missing, now)) moveBy(v, missing * n, now);
}

/// The mass of the corners of a face from number `first` on [kg]; 0 if one has prescribed motion.
double massOf(const Face& face, int first, const std::vector<double>& mass) {
  double sum = 0.0;
  for (int k = first; k < 3; ++k) {
    if (mass[face[k]] == 0.0) return 0.0;
    sum += mass[face[k]];
  }
  return sum;
}

/// Parts a corner along `way` [m] from those that both faces share, by their masses. A held one
/// gives way where it may not slide: otherwise a clamp may never pull cloth out of a fold.
void partFromShared(VertexId v, const FacePair& pair, const Vec3& way, const Truncation& now) {
  const int first = 3 - pair.shared;
  const double own = now.motion.mass[v];
  const double others = massOf(pair.a, first, now.motion.mass);
  double share = others == 0.0 ? 1.0 : others / (own + others);
  if (own == 0.0) share = maySlide(v, way.norm(), now) ? 1.0 : 0.0;
  if (share > 0.0) moveBy(v, share * way, now);
  if (share == 1.0 || others == 0.0) return;
  for (int k = first; k < 3; ++k) moveBy(pair.a[k], (share - 1.0) * way, now);
}

/// Returns where along `n` the middle of two faces lies that slide apart to the distance `keep` and
/// conserve momentum [m]. Corners of a have to end at half of it above, those of b below.
double middleOf(const FacePair& pair, const Vec3& n, double keep, const SubstepMotion& motion) {
  std::array<double, 3> a, b;  // where corners touch the middle
  std::array<double, 6> touching;
  for (int k = 0; k < 3; ++k) {
    a[k] = touching[k] = n.dot(motion.end[pair.a[k]]) - 0.5 * keep;
    b[k] = touching[k + 3] = n.dot(motion.end[pair.b[k]]) + 0.5 * keep;
  }
  std::sort(touching.begin(), touching.end());
  // The momentum that both sides gain, which grows with the middle, and linearly between corners.
  const auto gain = [&](double middle) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      sum += motion.mass[pair.a[k]] * std::max(0.0, middle - a[k]);
      sum -= motion.mass[pair.b[k]] * std::max(0.0, b[k] - middle);
    }
    return sum;
  };
  double low = touching[0];
  double atLow = gain(low);
  for (const double high : touching) {
    const double atHigh = gain(high);
    if (atHigh >= 0.0 && atHigh > atLow) return low + (high - low) * atLow / (atLow - atHigh);
    low = high;
    atLow = atHigh;
  }
  return low;
}

/// Slides two faces without a common corner apart along `n`, to the distance `keep` [m]. A side
/// with a held corner stays where it is, unless both have one.
void slideApart(const FacePair& pair, const Vec3& n, double keep, const Truncation& now) {
  const SubstepMotion& motion = now.motion;
  const bool isHeldA = massOf(pair.a, 0, motion.mass) == 0.0;
  const bool isHeldB = massOf(pair.b, 0, motion.mass) == 0.0;
  const double high = leastOf(pair.a, n, motion.end) - 0.5 * keep;
  const double low = mostOf(pair.b, n, motion.end) + 0.5 * keep;
  const double middle = isHeldA && isHeldB ? 0.5 * (low + high)
                        : isHeldA          ? high
                        : isHeldB          ? low
                                           : middleOf(pair, n, keep, motion);
  for (const VertexId v : pair.a) slideBeyond(v, n, middle + 0.5 * keep, now);
  for (const VertexId v : pair.b) slideBeyond(v, -n, 0.5 * keep - middle, now);
}

/// Slides the corners of two faces along `n` to the distance `keep` from those that both share [m].
void slideFromShared(const FacePair& pair, const Vec3& n, double keep, const Truncation& now) {
  const std::vector<Vec3>& end = now.motion.end;
  for (int k = 0; k < 3 - pair.shared; ++k) {
    for (const double side : {1.0, -1.0}) {
      const VertexId v = side > 0.0 ? pair.a[k] : pair.b[k];
      double top = side * n.dot(end[pair.a[2]]);  // of the shared corners
      if (pair.shared == 2) {
        const double other = side * n.dot(end[pair.a[1]]);
        top = std::max(top, other) + std::abs(top - other);
      }
      const double missing = top + keep - side * n.dot(end[v]);
      if (missing > 0.0) partFromShared(v, pair, side * missing * n, now);
    }
  }
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
  const double common = n.dot(now.common);
  const double approachA = std::max(0.0, high - (leastOf(pair.a, n, now.motion.end) - common));
  const double approachB = std::max(0.0, mostOf(pair.b, n, now.motion.end) - common - low);
  const double all = approachA + approachB;
  const double plane = low + keep + (high - low - 2.0 * keep) * (all > 0.0 ? approachB / all : 0.5);
  for (const VertexId v : pair.a) keepBeyond(v, n, plane + keep, now);
  for (const VertexId v : pair.b) keepBeyond(v, -n, keep - plane, now);
}

}  // namespace

void moveBy(VertexId v, const Vec3& way, const Truncation& now) {
  now.motion.end[v] += way;
  now.truncated[v] = now.pass;
}

void moveBack(VertexId v, double t, const Truncation& now) {
  if (!(t < 1.0)) return;
  const SubstepMotion& motion = now.motion;
  const Vec3 kept = motion.start[v] + now.common;
  motion.end[v] = kept + std::max(0.0, t) * (motion.end[v] - kept);
  now.truncated[v] = now.pass;
}

bool slide(const FacePair& pair, double least, const Truncation& now) {
  const SeparatingDirection before = bestDirection(pair, now.motion.start);
  if (!(before.distance > 0.0)) return false;
  const Vec3 n = endDirection(pair, before.direction, now.motion.end);
  const double keep =
      std::max({kKeepSliding * before.distance, std::min(before.distance, least), kLeast});
  if (pair.shared == 0) {
    slideApart(pair, n, keep, now);
  } else {
    slideFromShared(pair, n, keep, now);
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
