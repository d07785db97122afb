#include "allowance.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "support/simd.h"
#include "support/vector_clones.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Faces that are renewed in sum until all are, over the most at a time.
constexpr double kMostRenewed = 5.0;
/// Slots of a segment: a box around their motion bounds how they move against each other.
constexpr std::int32_t kSegment = 16;
/// Side of a patch, in cells.
constexpr double kPatch = 8.0;

constexpr std::int32_t kSegmentGrain = 256;
constexpr std::int32_t kFaceGrain = 2048;
constexpr std::int32_t kVertexGrain = 4096;

template <typename Body>
void forAll(std::size_t count, std::int32_t grain, const Body& body) {
  parallelFor(static_cast<std::int32_t>(count), grain, [&](std::int32_t first, std::int32_t last) {
    for (std::int32_t k = first; k < last; ++k) body(k);
  });
}

/// Motion of consecutive slots since a search.
struct SegmentMotion {
  ConstAxes x;     ///< positions [m]
  ConstAxes from;  ///< positions at the search [m]
  ConstAxes low;   ///< least displacement that is allowed [m]
  ConstAxes high;  ///< largest one [m]
  Axes moved;      ///< displacement, to be set [m]
};

/// Sets the displacements of a segment's slots along an axis against `common` [m], and the least
/// and the largest of them. \return whether all are allowed; false for NaN.
[[gnu::always_inline]] inline bool moveAxis(const double* x, const double* from, const double* low,
                                            const double* high, double common, double* moved,
                                            double& least, double& most) {
  const Lanes first = lanesAt(x) - lanesAt(from) - common;
  Lanes below = first;
  Lanes above = first;
  auto kept = first == first;
  for (std::int32_t k = 0; k < kSegment; k += kLanes) {
    const Lanes now = lanesAt(x + k) - lanesAt(from + k) - common;
    lanesAt(moved + k) = now;
    below = now < below ? now : below;
    above = now > above ? now : above;
    kept &= (now >= lanesAt(low + k)) & (now <= lanesAt(high + k));
  }
  least = std::min(std::min(below[0], below[1]), std::min(below[2], below[3]));
  most = std::max(std::max(above[0], above[1]), std::max(above[2], above[3]));
  return (kept[0] & kept[1] & kept[2] & kept[3]) != 0;
}

/// Does so for `count` segments along all axes. \return whether all motion is allowed.
CLOTH_SIM_VECTOR_CLONES
bool moveSegments(const SegmentMotion& of, const Vec3& common, std::int32_t count, Box* boxes) {
  bool kept = true;
  for (std::int32_t s = 0; s < count; ++s) {
    const std::int32_t at = s * kSegment;
    double* const low = boxes[s].low.data();
    double* const high = boxes[s].high.data();
    kept &= moveAxis(of.x.x + at, of.from.x + at, of.low.x + at, of.high.x + at, common.x(),
                     of.moved.x + at, low[0], high[0]);
    kept &= moveAxis(of.x.y + at, of.from.y + at, of.low.y + at, of.high.y + at, common.y(),
                     of.moved.y + at, low[1], high[1]);
    kept &= moveAxis(of.x.z + at, of.from.z + at, of.low.z + at, of.high.z + at, common.z(),
                     of.moved.z + at, low[2], high[2]);
  }
  return kept;
}

/// Tells whether the edges of `count` faces have changed by no more than is allowed: a quick check.
/// \param corners  slots of the first, second and third corner of the faces.
/// \param turn     square of the change that is allowed, by face [m^2].
CLOTH_SIM_VECTOR_CLONES
bool areEdgesKept(const ConstAxes& moved, const std::array<const std::int32_t*, 3>& corners,
                  const double* turn, std::int32_t count) {
  auto kept = Lanes{} == Lanes{};
  for (std::int32_t k = 0; k + kLanes <= count; k += kLanes) {
    Lanes square{};
    for (const double* axis : {moved.x, moved.y, moved.z}) {
      const Lanes origin = gather(axis, corners[0] + k);
      const Lanes first = gather(axis, corners[1] + k) - origin;
      const Lanes second = gather(axis, corners[2] + k) - origin;
      square += first * first + second * second;
    }
    kept &= square <= lanesAt(turn + k);
  }
  return (kept[0] & kept[1] & kept[2] & kept[3]) != 0;
}

Vec2 middle(const TriangleMesh& mesh, const Face& face) {
  return (mesh.material(face[0]) + mesh.material(face[1]) + mesh.material(face[2])) / 3.0;
}

}  // namespace

void Allowance::build(const Model& model) {
  const TriangleMesh& mesh = model.mesh;
  faces_ = mesh.faces();
  inverseRest_.resize(faces_.size());
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Face& face = faces_[f];
    Eigen::Matrix2d rest;
    rest.col(0) = mesh.material(face[1]) - mesh.material(face[0]);
    rest.col(1) = mesh.material(face[2]) - mesh.material(face[0]);
    inverseRest_[f] = rest.inverse();
  }
  aroundStart_.assign(1, 0);
  facesAround_.clear();
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
    for (const FaceId f : mesh.facesAround(v)) facesAround_.push_back(f);
    aroundStart_.push_back(static_cast<std::int32_t>(facesAround_.size()));
  }
  const auto vertices = static_cast<std::size_t>(mesh.vertexCount());
  origin_.resize(vertices);
  motions_.resize(vertices);
  slots_.resize(vertices);
  for (VectorArray* array : {&from_, &low_, &high_, &moved_}) array->resize(vertices);
  balls_.resize(faces_.size());
  turn_.resize(faces_.size());
  sortIntoPatches(model);
}

/// Sorts the faces into squares of the material plane.
void Allowance::sortIntoPatches(const Model& model) {
  const TriangleMesh& mesh = model.mesh;
  double area = 0.0;
  for (FaceId f = 0; f < mesh.faceCount(); ++f) area += mesh.restArea(f);
  const double side = kPatch * std::sqrt(2.0 * area / static_cast<double>(faces_.size()));
  using Key = std::array<std::int32_t, 3>;
  std::vector<std::pair<Key, FaceId>> order;
  order.reserve(faces_.size());
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    const Vec2 at = middle(mesh, faces_[f]) / side;
    const auto cloth = static_cast<std::int32_t>(model.clothOf(faces_[f][0]));
    order.push_back({{cloth, static_cast<std::int32_t>(std::floor(at.y())),
                      static_cast<std::int32_t>(std::floor(at.x()))},
                     f});
  }
  std::sort(order.begin(), order.end());
  patches_.clear();
  patchFaces_.clear();
  placeOf_.resize(faces_.size());
  patchOf_.resize(faces_.size());
  patchTurn_.resize(faces_.size());
  for (std::vector<std::int32_t>& corner : corners_) corner.resize(faces_.size());
  hasSegments_ = false;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k == 0 || order[k].first != order[k - 1].first) {
      patches_.emplace_back();
      patches_.back().firstFace = static_cast<std::int32_t>(k);
    }
    placeOf_[order[k].second] = static_cast<std::int32_t>(k);
    patchFaces_.push_back(order[k].second);
    patchOf_[order[k].second] = static_cast<std::int32_t>(patches_.size()) - 1;
    patches_.back().lastFace = static_cast<std::int32_t>(k) + 1;
  }
}

Gradient Allowance::gradient(FaceId f, const std::vector<Vec3>& x) const {
  const Face& face = faces_[f];
  return Gradient::of(x[face[1]] - x[face[0]], x[face[2]] - x[face[0]], inverseRest_[f]);
}

/// Mean displacement of some vertices, evenly spread over all [m]. Any vector would do for what all
/// have in common, so a sample suffices.
/// \param motionOf  displacement of a vertex [m].
template <typename MotionOf>
Vec3 Allowance::meanMotion(const MotionOf& motionOf) const {
  constexpr std::size_t kSample = 256;
  const std::size_t stride = std::max<std::size_t>(1, origin_.size() / kSample);
  Vec3 sum = Vec3::Zero();
  std::size_t count = 0;
  for (std::size_t v = 0; v < origin_.size(); v += stride, ++count) sum += motionOf(v);
  return count == 0 ? sum : Vec3(sum / static_cast<double>(count));
}

/// Sets where a vertex may go: some substeps ahead like this one, or stopped by an obstacle, in
/// this substep at least.
/// \param offset  from its origin to the start of the substep, seen from the mean [m].
/// \param motion  in the substep, seen from the mean [m].
/// \param common  mean motion in the substep [m].
void Allowance::allowMotion(std::size_t v, const Vec3& offset, const Vec3& motion,
                            const Vec3& common) {
  const auto aheadOf = [this](const Vec3& of) {
    const double length = of.cwiseAbs().maxCoeff();
    const double most = length > 0.0 ? reach_.mostMotion / length : reach_.substeps;
    return Vec3(std::max(1.5, std::min(reach_.substeps, most)) * of);
  };
  const Vec3 stopped = aheadOf(-common);
  const Vec3 ahead = aheadOf(motion);
  const Vec3 low = ahead.cwiseMin(stopped).cwiseMin(0.0).array() - reach_.leastMotion;
  const Vec3 high = ahead.cwiseMax(stopped).cwiseMax(0.0).array() + reach_.leastMotion;
  motions_[v] = {offset + low, offset + high};
}

/// Sets the gradients that a face may have.
void Allowance::allowTurn(FaceId f, const std::vector<Vec3>& start, const std::vector<Vec3>& end) {
  GradientBall& ball = balls_[f];
  ball.centre = gradient(f, start);
  const double turned = (gradient(f, end) - ball.centre).norm();
  ball.radius = std::max(reach_.leastTurn, reach_.substeps * turned);
}

void Allowance::renew(const std::vector<Vec3>& start, const std::vector<Vec3>& end,
                      const Reach& reach) {
  reach_ = reach;
  origin_ = start;
  renewed_ = 0;
  const Vec3 common = meanMotion([&](std::size_t v) -> Vec3 { return end[v] - start[v]; });
  forAll(origin_.size(), kVertexGrain, [&](std::int32_t v) {
    allowMotion(static_cast<std::size_t>(v), Vec3::Zero(), end[v] - start[v] - common, common);
  });
  forAll(faces_.size(), kFaceGrain, [&](FaceId f) {
    allowTurn(f, start, end);
    turn_[f] = balls_[f].radius * balls_[f].radius / inverseRest_[f].squaredNorm();
  });
}

void Allowance::follow(const ParticleView& particles) {
  for (VertexId v = 0; v < static_cast<VertexId>(slots_.size()); ++v) {
    const std::int32_t slot = particles.slot(v);
    if (slot != slots_[v]) hasSegments_ = false;
    slots_[v] = slot;
    setSlot(v);
  }
  if (!hasSegments_) listSegments();
  for (Patch& patch : patches_) {
    patch.turn = std::numeric_limits<double>::infinity();
    for (std::int32_t k = patch.firstFace; k < patch.lastFace; ++k) {
      patchTurn_[k] = turn_[patchFaces_[k]];
      patch.turn = std::min(patch.turn, patchTurn_[k]);
    }
  }
}

/// Lists the segments of slots that the corners of each patch lie in.
void Allowance::listSegments() {
  segments_.resize((slots_.size() + kSegment - 1) / kSegment);
  for (Patch& patch : patches_) {
    std::vector<std::int32_t>& list = patch.segments;
    list.clear();
    for (std::int32_t k = patch.firstFace; k < patch.lastFace; ++k) {
      for (int corner = 0; corner < 3; ++corner) {
        corners_[corner][k] = slots_[faces_[patchFaces_[k]][corner]];
        list.push_back(corners_[corner][k] / kSegment);
      }
    }
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  hasSegments_ = true;
}

void Allowance::setSlot(VertexId v) {
  const auto slot = static_cast<std::size_t>(slots_[v]);
  from_.set(slot, origin_[v]);
  low_.set(slot, motions_[v].low);
  high_.set(slot, motions_[v].high);
}

bool Allowance::isKept(const ParticleView& particles) {
  const Vec3 common =
      meanMotion([&](std::size_t v) -> Vec3 { return particles.at(slots_[v]) - origin_[v]; });
  std::atomic<bool> kept{true};
  parallelFor(static_cast<std::int32_t>(segments_.size()), kSegmentGrain,
              [&](std::int32_t first, std::int32_t last) {
                if (!move(particles, common, first, last)) kept = false;
              });
  constexpr std::int32_t kPatchGrain = 64;
  parallelFor(static_cast<std::int32_t>(patches_.size()), kPatchGrain,
              [&](std::int32_t first, std::int32_t last) {
                for (std::int32_t k = first; k < last && kept; ++k) {
                  if (!isTurnKept(patches_[k])) kept = false;
                }
              });
  return kept;
}

/// Finds the motion of the slots of some segments, and boxes around it. \return whether it is
/// allowed.
bool Allowance::move(const ParticleView& particles, const Vec3& common, std::int32_t first,
                     std::int32_t last) {
  const auto slots = static_cast<std::int32_t>(slots_.size());
  const std::int32_t whole = std::min(last, slots / kSegment);
  const std::int32_t at = first * kSegment;
  bool kept = true;
  if (whole > first) {
    kept = moveSegments({{particles.x + at, particles.y + at, particles.z + at},
                         axesAt(std::as_const(from_), at),
                         axesAt(std::as_const(low_), at),
                         axesAt(std::as_const(high_), at),
                         axesAt(moved_, at)},
                        common, whole - first, &segments_[first]);
  }
  if (whole == last) return kept;
  segments_[whole] = Box();
  for (std::int32_t slot = whole * kSegment; slot < slots; ++slot) {
    const auto k = static_cast<std::size_t>(slot);
    const Vec3 moved = particles.at(slot) - from_.at(k) - common;
    moved_.set(k, moved);
    segments_[whole].add({moved, moved});
    kept = kept && Box{low_.at(k), high_.at(k)}.contains(moved);
  }
  return kept;
}

/// Tells whether the gradients of the faces of a patch are where they may be. The edges of all
/// change by no more than the diagonal of a box around the motion of all corners.
bool Allowance::isTurnKept(const Patch& patch) const {
  Box box;
  for (const std::int32_t segment : patch.segments) box.add(segments_[segment]);
  if (2.0 * (box.high - box.low).squaredNorm() <= patch.turn) return true;
  const std::int32_t first = patch.firstFace;
  const std::int32_t quick = (patch.lastFace - first) / kLanes * kLanes;
  const bool areMost = areEdgesKept(axesAt(moved_, 0),
                                    {&corners_[0][first], &corners_[1][first], &corners_[2][first]},
                                    &patchTurn_[first], quick);
  for (std::int32_t k = areMost ? first + quick : first; k < patch.lastFace; ++k) {
    if (!isTurnKept(patchFaces_[k])) return false;
  }
  return true;
}

/// Tells whether the gradient of a face is where it may be.
bool Allowance::isTurnKept(FaceId f) const {
  const Face& face = faces_[f];
  const Vec3 moved = moved_.at(static_cast<std::size_t>(slots_[face[0]]));
  const Vec3 first = moved_.at(static_cast<std::size_t>(slots_[face[1]])) - moved;
  const Vec3 second = moved_.at(static_cast<std::size_t>(slots_[face[2]])) - moved;
  // The norm of the edges' change bounds that of the gradient.
  if (first.squaredNorm() + second.squaredNorm() <= turn_[f]) return true;
  const Gradient now = Gradient::of(first + origin_[face[1]] - origin_[face[0]],
                                    second + origin_[face[2]] - origin_[face[0]], inverseRest_[f]);
  return (now - balls_[f].centre).norm() <= balls_[f].radius;
}

/// Lists the vertices that are not where they may be, and the faces with such a corner or with a
/// gradient that is not. \return whether these are few; if not, the lists are not complete.
bool Allowance::findLeft(double few) {
  left_.vertices.clear();
  left_.faces.clear();
  const auto most = static_cast<std::size_t>(few * static_cast<double>(faces_.size()));
  for (std::size_t v = 0; v < slots_.size(); ++v) {
    if (motions_[v].contains(moved_.at(static_cast<std::size_t>(slots_[v])))) continue;
    left_.vertices.push_back(static_cast<VertexId>(v));
    left_.faces.insert(left_.faces.end(), facesAround_.begin() + aroundStart_[v],
                       facesAround_.begin() + aroundStart_[v + 1]);
    if (left_.faces.size() > 2 * most) return false;  // each is there three times at most
  }
  for (const Patch& patch : patches_) {
    if (isTurnKept(patch)) continue;
    for (std::int32_t k = patch.firstFace; k < patch.lastFace; ++k) {
      if (!isTurnKept(patchFaces_[k])) left_.faces.push_back(patchFaces_[k]);
    }
  }
  std::sort(left_.faces.begin(), left_.faces.end());
  left_.faces.erase(std::unique(left_.faces.begin(), left_.faces.end()), left_.faces.end());
  return left_.faces.size() <= most;
}

bool Allowance::renewLeft(const std::vector<Vec3>& start, const std::vector<Vec3>& end,
                          double few) {
  if (!findLeft(few)) return false;
  renewed_ += static_cast<std::int64_t>(left_.faces.size());
  const double most = kMostRenewed * few * static_cast<double>(faces_.size());
  if (static_cast<double>(renewed_) > most) return false;
  const Vec3 before = meanMotion([&](std::size_t v) -> Vec3 { return start[v] - origin_[v]; });
  const Vec3 common = meanMotion([&](std::size_t v) -> Vec3 { return end[v] - start[v]; });
  for (const VertexId v : left_.vertices) {
    allowMotion(static_cast<std::size_t>(v), start[v] - origin_[v] - before,
                end[v] - start[v] - common, common);
    setSlot(v);
  }
  for (const FaceId f : left_.faces) {
    allowTurn(f, start, end);
    // The centre of the ball is no longer the gradient at the origin: there is no quick check.
    turn_[f] = -1.0;
    patchTurn_[placeOf_[f]] = -1.0;
    patches_[patchOf_[f]].turn = -1.0;
  }
  return true;
}

}  // namespace cloth_sim
