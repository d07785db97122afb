#include "feature_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace cloth_sim {
namespace {

constexpr FaceId kFaceBlock = 64;      // faces that are searched for together
constexpr int kSweeps = 20;            // over all pairs, as long as any is pushed
constexpr double kLeastAngle = 1e-3;   // sine of the least angle of two edges
constexpr double kBeside = 1e-9;       // weights by which a point may be beside a face [-]
constexpr double kMostLeverage = 4.0;  // displacement of a particle over that of the point [-]
constexpr double kLeastPush = 1e-13;   // pushes below it are round-off [m]

using Points = std::array<Vec3, 3>;     // of a face; an edge has two
using Weights = std::array<double, 3>;  // sum 1

/// A corner of the mesh and a face of the cloth.
struct CornerAtFace {
  static constexpr int kPoints = 3;
  Vec3 point;  ///< [m]

  /// Finds the unit normal of a face. \return false if it has no area.
  static bool normal(const Points& x, Vec3& out) {
    out = (x[1] - x[0]).cross(x[2] - x[0]);
    const double size = out.norm();
    out /= size;
    return size > 0.0;
  }
  /// Six times the volume between the face and the corner [m^3]; its sign is the side.
  double volume(const Points& x) const {
    return (x[1] - x[0]).cross(x[2] - x[0]).dot(point - x[0]);
  }
  /// Finds the weights of the foot of the corner. \return whether it is in the face.
  bool weigh(const Points& x, const Vec3& normal, Weights& weight) const {
    const Vec3 foot = point - x[0];
    const Vec3 a = x[1] - x[0];
    const Vec3 b = x[2] - x[0];
    const double area = normal.dot(a.cross(b));
    weight[1] = normal.dot(foot.cross(b)) / area;
    weight[2] = normal.dot(a.cross(foot)) / area;
    weight[0] = 1.0 - weight[1] - weight[2];
    return *std::min_element(weight.begin(), weight.end()) >= -kBeside;
  }
};

/// An edge of the mesh and an edge of the cloth.
struct EdgeAtEdge {
  static constexpr int kPoints = 2;
  Vec3 point;  ///< one end [m]
  Vec3 along;  ///< from there to the other end [m]

  /// Finds the unit vector normal to both. \return false if they are parallel.
  bool normal(const Points& x, Vec3& out) const {
    const Vec3 edge = x[1] - x[0];
    out = along.cross(edge);
    const double size = out.norm();
    out /= size;
    return size > kLeastAngle * along.norm() * edge.norm();
  }
  /// Six times the volume between both edges [m^3]; its sign is the side.
  double volume(const Points& x) const { return along.cross(x[1] - x[0]).dot(point - x[0]); }
  /// Finds the weights of the point of the cloth that is closest to the line of the edge.
  /// \return whether the closest points of both lines are on the edges.
  bool weigh(const Points& x, const Vec3& normal, Weights& weight) const {
    const Vec3 edge = x[1] - x[0];
    const double size = normal.dot(along.cross(edge));
    const Vec3 apart = x[0] - point;
    const double onMesh = normal.dot(apart.cross(edge)) / size;
    weight[1] = normal.dot(apart.cross(along)) / size;
    weight[0] = 1.0 - weight[1];
    weight[2] = 0.0;
    const auto isOn = [](double part) { return part >= -kBeside && part <= 1.0 + kBeside; };
    return isOn(onMesh) && isOn(weight[1]);
  }
};

/// Calls `function` with the feature in space.
template <class Function>
decltype(auto) visitFeature(const PlacedFeatures& placed, std::int32_t feature,
                            Function&& function) {
  const SharpFeature& it = placed.features[feature];
  const Vec3 point = placed.position + placed.rotation * it.ends[0];
  if (it.isCorner) return function(CornerAtFace{point});
  return function(EdgeAtEdge{point, placed.rotation * (it.ends[1] - it.ends[0])});
}

// ---- search -------------------------------------------------------------------------------------

/// A box that grows around points.
struct PointBox {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;

  void add(const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

/// Finds the pairs of one mesh and one cloth.
class PairSearch {
 public:
  PairSearch(const PlacedFeatures& placed, const TriangleMesh& mesh, const State& state,
             const FeatureSearch& search, std::vector<std::int32_t>& scratch,
             std::vector<FeaturePair>& out)
      : placed_(placed), mesh_(mesh), state_(state), search_(search), found_(scratch), out_(out) {}

  void run() {
    for (FaceId first = 0; first < mesh_.faceCount(); first += kFaceBlock) {
      const FaceId last = std::min(first + kFaceBlock, mesh_.faceCount());
      if (!mayMeet(first, last)) continue;
      for (FaceId f = first; f < last; ++f) search(mesh_.face(f));
    }
  }

 private:
  /// Distance that a particle may move relative to the mesh [m].
  double pathOf(VertexId v) const {
    const double path = search_.dt * (state_.v[v] - search_.velocity).norm();
    return path + search_.turn * ((state_.x[v] - placed_.position).norm() + path);
  }
  Vec3 localOf(VertexId v) const {
    return placed_.rotation.transpose() * (state_.x[v] - placed_.position);
  }

  /// Tells whether a feature may be met by a block of faces, whose box is turned as a whole.
  bool mayMeet(FaceId first, FaceId last) const {
    PointBox world;
    double path = 0.0;
    for (FaceId f = first; f < last; ++f) {
      for (const VertexId v : mesh_.face(f)) {
        world.add(state_.x[v]);
        path = std::max(path, pathOf(v));
      }
    }
    const Vec3 centre =
        placed_.rotation.transpose() * (0.5 * (world.low + world.high) - placed_.position);
    const Vec3 half = placed_.rotation.transpose().cwiseAbs() * (0.5 * (world.high - world.low)) +
                      Vec3::Constant(path + search_.reach);
    return placed_.features.areIn(centre - half, centre + half);
  }

  void search(const Face& face) {
    PointBox box;
    double path = 0.0;
    for (const VertexId v : face) {
      box.add(localOf(v));
      path = std::max(path, pathOf(v));
    }
    const Vec3 room = Vec3::Constant(path + search_.reach);
    placed_.features.find(box.low - room, box.high + room, found_);
    for (const std::int32_t feature : found_) {
      if (placed_.features[feature].isCorner) {
        add({feature, {face[0], face[1], face[2]}});
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        const VertexId a = face[k];
        const VertexId b = face[(k + 1) % 3];
        // An edge between two faces runs up in one of them.
        if (a > b && mesh_.facesOnEdge(a, b)[1] != kNone) continue;
        add({feature, {a, b, kNone}});
      }
    }
  }

  void add(FeaturePair pair) {
    pair.isPierced = placed_.surface.isClosed() && isPierced(pair);
    out_.push_back(pair);
  }

  /// Tells whether the point of the cloth that is opposite to the feature is inside of the mesh.
  bool isPierced(const FeaturePair& pair) const {
    return visitFeature(placed_, pair.feature, [&](const auto& meeting) {
      Points x{};
      for (int k = 0; k < meeting.kPoints; ++k) x[k] = state_.x[pair.cloth[k]];
      Vec3 normal;
      Weights weight;
      if (!meeting.normal(x, normal) || !meeting.weigh(x, normal, weight)) return false;
      Vec3 point = Vec3::Zero();
      for (int k = 0; k < meeting.kPoints; ++k) point += weight[k] * x[k];
      return placed_.surface.distance(placed_.rotation.transpose() * (point - placed_.position)) <
             0.0;
    });
  }

  const PlacedFeatures& placed_;
  const TriangleMesh& mesh_;
  const State& state_;
  const FeatureSearch& search_;
  std::vector<std::int32_t>& found_;
  std::vector<FeaturePair>& out_;
};

// ---- projection ---------------------------------------------------------------------------------

/// The paths of the corners of a face, or of the ends of an edge, in the frame of the collider.
struct ClothPaths {
  Points start{};
  Points end{};

  Points at(double t) const {
    Points x;
    for (int k = 0; k < 3; ++k) x[k] = (1.0 - t) * start[k] + t * end[k];
    return x;
  }
};

/// A point of the cloth that a feature stops.
struct Stop {
  Weights weight{};
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
bool weighAt(const Meeting& meeting, const ClothPaths& paths, double t, Weights& weight) {
  const Points x = paths.at(t);
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
bool weighCrossing(const Meeting& meeting, const ClothPaths& paths, Weights& weight) {
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
    Weights weight;
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
  bool move(const FeaturePair& pair, const Weights& weight, const Vec3& by) {
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

void collectPairs(const PlacedFeatures& placed, const TriangleMesh& mesh, const State& state,
                  const FeatureSearch& search, std::vector<std::int32_t>& scratch,
                  std::vector<FeaturePair>& out) {
  PairSearch(placed, mesh, state, search, scratch, out).run();
}

Moments projectPairs(const PlacedFeatures& placed, const ColliderSubstep& substep, double margin,
                     const ParticleView& particles, std::vector<FeaturePair>& pairs) {
  return PairProjection(placed, substep, margin, particles).project(pairs);
}

Moments certifyPairs(const PlacedFeatures& placed, const ColliderSubstep& substep,
                     const ParticleView& particles, std::vector<FeaturePair>& pairs) {
  return PairProjection(placed, substep, 0.0, particles).certify(pairs);
}

}  // namespace cloth_sim
