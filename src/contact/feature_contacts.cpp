#include "feature_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cloth_sim {
namespace {

constexpr int kSweeps = 20;            // over all pairs, as long as any is pushed
constexpr double kMostLeverage = 4.0;  // displacement of a particle over that of the point [-]
constexpr double kLeastPush = 1e-13;   // pushes below it are round-off [m]

/// The paths of the corners of a face, or of the ends of an edge, in the frame of the collider.
struct ClothPaths {
  MeetingPoints start{};
  MeetingPoints end{};

  MeetingPoints at(double t) const {
    MeetingPoints x;
    for (int k = 0; k < 3; ++k) x[k] = (1.0 - t) * start[k] + t * end[k];
    return x;
  }
};

/// A point of the cloth that a feature stops.
struct Stop {
  MeetingWeights weight{};
  SweepHit hit;
};

/// Limits on the distance of a point of the cloth.
struct Limits {
  double margin;  ///< that it keeps [m]
  double rise;    ///< on the push of one that starts nearer [m]
};

/// Finds the weights of the point of the cloth that is opposite to the feature at a time from 0
/// to 1. \return false if there is none.
template <class Meeting>
bool weighAt(const Meeting& meeting, const ClothPaths& paths, double t, MeetingWeights& weight) {
  const MeetingPoints x = paths.at(t);
  Vec3 normal;
  return meeting.normal(x, normal) && meeting.weigh(x, normal, weight);
}

/// A cubic polynomial over 0 to 1.
class Cubic {
 public:
  /// \param values  at 0, 1/3, 2/3 and 1.
  explicit Cubic(const std::array<double, 4>& values) {
    const auto& [a, b, c, d] = values;
    coefficients_ = {a, -5.5 * a + 9.0 * b - 4.5 * c + d, 9.0 * a - 22.5 * b + 18.0 * c - 4.5 * d,
                     -4.5 * a + 13.5 * b - 13.5 * c + 4.5 * d};
  }

  /// Calls `function(t)` with each place where the sign changes, in order, until it returns true.
  /// \return whether it did.
  template <class Function>
  bool visitCrossings(Function&& function) const {
    const std::array<double, 4> ends = monotonePieces();
    for (int k = 0; k < 3; ++k) {
      const bool isPositive = at(ends[k]) > 0.0;
      if (ends[k] >= ends[k + 1] || (at(ends[k + 1]) > 0.0) == isPositive) continue;
      double low = ends[k];
      double high = ends[k + 1];
      for (int halving = 0; halving < kHalvings; ++halving) {
        const double middle = 0.5 * (low + high);
        ((at(middle) > 0.0) == isPositive ? low : high) = middle;
      }
      if (function(high)) return true;
    }
    return false;
  }

 private:
  static constexpr int kHalvings = 40;

  double at(double t) const {
    const auto& c = coefficients_;
    return c[0] + t * (c[1] + t * (c[2] + t * c[3]));
  }

  /// 0, the places between 0 and 1 at which it turns, and 1.
  std::array<double, 4> monotonePieces() const {
    const double a = 3.0 * coefficients_[3];
    const double b = coefficients_[2];  // half of the linear coefficient of the derivative
    const double c = coefficients_[1];
    const double root = std::sqrt(std::max(0.0, b * b - a * c));
    const double q = -(b + std::copysign(root, b));
    const auto within = [](double t) { return t > 0.0 && t < 1.0 ? t : 1.0; };
    const double s = within(q / a);
    const double t = within(c / q);
    return {0.0, std::min(s, t), std::max(s, t), 1.0};
  }

  std::array<double, 4> coefficients_{};
};

/// Finds the weights of the point at which the cloth passes through the feature first. (Provot
/// 1997: corners and edges of triangles on straight paths meet at roots of a cubic.) \return false
/// if it does not.
template <class Meeting>
bool weighCrossing(const Meeting& meeting, const ClothPaths& paths, MeetingWeights& weight) {
  const Cubic volume({meeting.volume(paths.start), meeting.volume(paths.at(1.0 / 3.0)),
                      meeting.volume(paths.at(2.0 / 3.0)), meeting.volume(paths.end)});
  return volume.visitCrossings([&](double t) { return weighAt(meeting, paths, t, weight); });
}

/// Finds out whether a feature stops the cloth. \param side  1 if the feature is on the side of the
/// cloth to which its normal points, else -1; 0: to be found.
template <class Meeting>
bool findStop(const Meeting& meeting, const ClothPaths& paths, const Limits& limits,
              const FeaturePair& pair, const Vec3& outwards, int& side, Stop& stop) {
  Vec3 first;
  Vec3 last;
  if (!meeting.normal(paths.start, first) || !meeting.normal(paths.end, last)) return false;
  if (first.dot(last) <= 0.0) return false;  // it turns over: no plane tells the side
  const double distance = first.dot(meeting.point - paths.start[0]);
  if (pair.isPierced) {
    side = first.dot(outwards) > 0.0 ? -1 : 1;
  } else if (side == 0) {
    side = distance >= 0.0 ? 1 : -1;
  }
  const double before = side * distance;
  const double after = side * last.dot(meeting.point - paths.end[0]);
  if (after >= limits.margin) return false;
  const double near = before > limits.margin ? (before - limits.margin) / (before - after) : 1.0;
  if (!weighAt(meeting, paths, near, stop.weight) && !weighCrossing(meeting, paths, stop.weight)) {
    return false;
  }
  stop.hit.normal = -side * last;
  stop.hit.push = std::min(0.0, before - limits.margin + limits.rise) - (after - limits.margin);
  return stop.hit.push > kLeastPush;
}

/// Projects the pairs of one mesh and one cloth, one after the other.
class PairProjection {
 public:
  PairProjection(const PlacedFeatures& placed, const ColliderSubstep& substep, double margin,
                 const ParticleView& particles)
      : placed_(placed), substep_(substep), limits_{margin, substep.rise}, particles_(particles) {}

  Moments project(std::vector<FeaturePair>& pairs) {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      bool isAnyPushed = false;
      for (FeaturePair& pair : pairs) {
        if (sweep == 0) pair.isNear = pair.isPierced || isNear(pair);
        if (!pair.isNear) {
          pair.side = 0;
          continue;
        }
        // Of what intersects, corners part, once in a substep: more throws the cloth away.
        if (pair.isPierced && (sweep > 0 || pair.cloth[2] == kNone)) continue;
        const bool isPushed = push(pair);
        if (sweep == 0 && !isPushed) pair.side = 0;
        isAnyPushed |= isPushed;
      }
      if (!isAnyPushed) break;
    }
    return moments_;
  }

  /// Lets all particles of a pair whose paths pass through each other move along with the collider,
  /// as long as there are such pairs. Where the cloth does not move relative to it, nothing can
  /// pass.
  Moments certify(std::vector<FeaturePair>& pairs) {
    // Intersecting pairs must be able to part.
    if (std::any_of(pairs.begin(), pairs.end(), [](const FeaturePair& p) { return p.isPierced; })) {
      return moments_;
    }
    for (bool isAnyTaken = true; isAnyTaken;) {
      isAnyTaken = false;
      for (FeaturePair& pair : pairs) {
        if (isNear(pair) && passes(pair)) isAnyTaken |= take(pair);
      }
    }
    return moments_;
  }

 private:
  static int countOf(const FeaturePair& pair) { return pair.cloth[2] == kNone ? 2 : 3; }

  bool passes(const FeaturePair& pair) const {
    const ClothPaths paths = pathsOf(pair);
    MeetingWeights weight;
    return visitFeature(placed_, pair.feature,
                        [&](const auto& meeting) { return weighCrossing(meeting, paths, weight); });
  }

  /// Lets the particles of a pair move along with the collider. \return whether any did not.
  bool take(const FeaturePair& pair) {
    bool isAnyMoved = false;
    for (int k = 0; k < countOf(pair); ++k) {
      const std::int32_t slot = particles_.slot(pair.cloth[k]);
      const Vec3 at = particles_.at(slot);
      const Vec3 to = substep_.carried(particles_.startAt(slot));
      if (!(particles_.mass[slot] > 0.0) || to == at) continue;
      set(slot, to);
      moments_.add(particles_.mass[slot], at, to - at);
      isAnyMoved = true;
    }
    return isAnyMoved;
  }

  void set(std::int32_t slot, const Vec3& to) {
    particles_.x[slot] = to.x();
    particles_.y[slot] = to.y();
    particles_.z[slot] = to.z();
  }

  /// Tells whether the boxes around the feature and around the paths meet.
  bool isNear(const FeaturePair& pair) const {
    const SharpFeature& feature = placed_.features[pair.feature];
    const Vec3 a = placed_.position + placed_.rotation * feature.ends[0];
    const Vec3 b =
        feature.isCorner ? a : Vec3(placed_.position + placed_.rotation * feature.ends[1]);
    PointBox box;
    for (int k = 0; k < countOf(pair); ++k) {
      const std::int32_t slot = particles_.slot(pair.cloth[k]);
      box.add(substep_.carried(particles_.startAt(slot)));
      box.add(particles_.at(slot));
    }
    const Vec3 low = a.cwiseMin(b) - box.high;
    const Vec3 high = box.low - a.cwiseMax(b);
    return std::max(low.maxCoeff(), high.maxCoeff()) <= limits_.margin;
  }

  ClothPaths pathsOf(const FeaturePair& pair) const {
    ClothPaths paths;
    for (int k = 0; k < countOf(pair); ++k) {
      const std::int32_t slot = particles_.slot(pair.cloth[k]);
      paths.start[k] = substep_.carried(particles_.startAt(slot));
      paths.end[k] = particles_.at(slot);
    }
    return paths;
  }

  bool push(FeaturePair& pair) {
    const ClothPaths paths = pathsOf(pair);
    int side = 0;
    if (pair.side != 0) side = pair.side > 0 ? 1 : -1;
    Stop stop;
    const Vec3 outwards = placed_.rotation * placed_.features[pair.feature].outwards;
    const bool stops = visitFeature(placed_, pair.feature, [&](const auto& meeting) {
      return findStop(meeting, paths, limits_, pair, outwards, side, stop);
    });
    if (!stops) return false;
    pair.side = static_cast<std::int8_t>(side);
    Vec3 anchor = Vec3::Zero();
    Vec3 end = Vec3::Zero();
    for (int k = 0; k < countOf(pair); ++k) {
      anchor += stop.weight[k] * paths.start[k];
      end += stop.weight[k] * paths.end[k];
    }
    // A point that has not moved towards the feature is not too near because of this substep.
    const double approach = std::max(0.0, stop.hit.normal.dot(anchor - end));
    stop.hit.push = std::min(stop.hit.push, approach + limits_.rise);
    return move(pair, stop.weight, stopAt(substep_, stop.hit, anchor, end) - end);
  }

  /// Moves the point of the cloth with these weights. \return false if nothing of it can move.
  bool move(const FeaturePair& pair, const MeetingWeights& weight, const Vec3& by) {
    std::array<double, 3> share{};  // of each particle in the displacement
    double sum = 0.0;
    for (int k = 0; k < countOf(pair); ++k) {
      const double mass = particles_.mass[particles_.slot(pair.cloth[k])];
      share[k] = mass > 0.0 ? weight[k] / mass : 0.0;
      sum += weight[k] * share[k];
    }
    if (!(sum > 0.0)) return false;
    const double most = *std::max_element(share.begin(), share.end()) / sum;
    const double scale = std::min(1.0, kMostLeverage / most) / sum;
    for (int k = 0; k < countOf(pair); ++k) {
      const std::int32_t slot = particles_.slot(pair.cloth[k]);
      const Vec3 at = particles_.at(slot);
      const Vec3 step = scale * share[k] * by;
      set(slot, at + step);
      moments_.add(particles_.mass[slot], at, step);
    }
    return true;
  }

  const PlacedFeatures& placed_;
  const ColliderSubstep& substep_;
  Limits limits_;
  const ParticleView& particles_;
  Moments moments_;
};

}  // namespace

Moments projectPairs(const PlacedFeatures& placed, const ColliderSubstep& substep, double margin,
                     const ParticleView& particles, std::vector<FeaturePair>& pairs) {
  return PairProjection(placed, substep, margin, particles).project(pairs);
}

Moments certifyPairs(const PlacedFeatures& placed, const ColliderSubstep& substep,
                     const ParticleView& particles, std::vector<FeaturePair>& pairs) {
  return PairProjection(placed, substep, 0.0, particles).certify(pairs);
}

}  // namespace cloth_sim
