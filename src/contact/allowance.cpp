#include "allowance.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

#include "support/vector_clones.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Substeps that it allows for, at the speed of the present one.
constexpr double kSubstepsAhead = 4.0;
/// Motion that it allows for at least [m].
constexpr double kLeastMotion = 4e-4;
/// Change of a face's gradient that it allows for at least [-].
constexpr double kLeastTurn = 0.2;
/// Most motion that it allows for, unless a single substep takes more [m].
constexpr double kMostMotion = 5e-3;
/// Share of the faces up to which some are renewed.
constexpr double kFew = 0.05;
/// Share of the faces that are renewed, in sum, until all are.
constexpr double kMostRenewed = 0.25;
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

/// Displacements along an axis of some slots since a search, and what is known of them.
struct AxisMotion {
  const double* x;     ///< positions [m]
  const double* from;  ///< positions at the search [m]
  const double* low;   ///< least displacement that is allowed [m]
  const double* high;  ///< largest one [m]
  double* moved;       ///< displacement, to be set [m]
};

/// Sets the displacements of `count` slots against `common` [m], and the least and the largest of
/// them. \return whether all are allowed; false for NaN.
CLOTH_SIM_VECTOR_CLONES
bool moveAxis(const AxisMotion& axis, double common, std::int32_t count, double& least,
              double& most) {
  std::int32_t kept = 0;
  double low[4] = {1e300, 1e300, 1e300, 1e300};  // by remainder of the number of the slot
  double high[4] = {-1e300, -1e300, -1e300, -1e300};
  for (std::int32_t k = 0; k + 4 <= count; k += 4) {
    for (std::int32_t lane = 0; lane < 4; ++lane) {
      const double moved = axis.x[k + lane] - axis.from[k + lane] - common;
      axis.moved[k + lane] = moved;
      low[lane] = moved < low[lane] ? moved : low[lane];
      high[lane] = moved > high[lane] ? moved : high[lane];
      kept += moved >= axis.low[k + lane] && moved <= axis.high[k + lane] ? 1 : 0;
    }
  }
  for (std::int32_t k = count / 4 * 4; k < count; ++k) {
    const double moved = axis.x[k] - axis.from[k] - common;
    axis.moved[k] = moved;
    low[0] = std::min(low[0], moved);
    high[0] = std::max(high[0], moved);
    kept += moved >= axis.low[k] && moved <= axis.high[k] ? 1 : 0;
  }
  least = std::min(std::min(low[0], low[1]), std::min(low[2], low[3]));
  most = std::max(std::max(high[0], high[1]), std::max(high[2], high[3]));
  return kept == count;
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
  patchOf_.resize(faces_.size());
  hasSegments_ = false;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k == 0 || order[k].first != order[k - 1].first) {
      patches_.emplace_back();
      patches_.back().firstFace = static_cast<std::int32_t>(k);
    }
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
  const auto aheadOf = [](const Vec3& of) {
    const double length = of.cwiseAbs().maxCoeff();
    const double most = length > 0.0 ? kMostMotion / length : kSubstepsAhead;
    return Vec3(std::max(1.5, std::min(kSubstepsAhead, most)) * of);
  };
  const Vec3 stopped = aheadOf(-common);
  const Vec3 ahead = aheadOf(motion);
  const Vec3 low = ahead.cwiseMin(stopped).cwiseMin(0.0).array() - kLeastMotion;
  const Vec3 high = ahead.cwiseMax(stopped).cwiseMax(0.0).array() + kLeastMotion;
  motions_[v] = {offset + low, offset + high};
}

/// Sets the gradients that a face may have.
void Allowance::allowTurn(FaceId f, const std::vector<Vec3>& start, const std::vector<Vec3>& end) {
  GradientBall& ball = balls_[f];
  ball.centre = gradient(f, start);
  const double turned = (gradient(f, end) - ball.centre).norm();
  ball.radius = std::max(kLeastTurn, kSubstepsAhead * turned);
}

void Allowance::renew(const std::vector<Vec3>& start, const std::vector<Vec3>& end) {
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
  for (std::size_t v = 0; v < slots_.size(); ++v) {
    const auto slot = static_cast<std::int32_t>(slotOf(particles, v));
    if (slot != slots_[v]) hasSegments_ = false;
    slots_[v] = slot;
    setSlot(static_cast<VertexId>(v));
  }
  if (!hasSegments_) listSegments();
  for (Patch& patch : patches_) {
    patch.turn = std::numeric_limits<double>::infinity();
    for (std::int32_t k = patch.firstFace; k < patch.lastFace; ++k) {
      patch.turn = std::min(patch.turn, turn_[patchFaces_[k]]);
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
      for (const VertexId v : faces_[patchFaces_[k]]) list.push_back(slots_[v] / kSegment);
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
  const Vec3 common = meanMotion([&](std::size_t v) -> Vec3 {
    const auto k = static_cast<std::size_t>(slots_[v]);
    return Vec3(particles.x[k], particles.y[k], particles.z[k]) - origin_[v];
  });
  std::atomic<bool> kept{true};
  parallelFor(static_cast<std::int32_t>(segments_.size()), kSegmentGrain,
              [&](std::int32_t first, std::int32_t last) {
                bool all = true;
                for (std::int32_t s = first; s < last; ++s) {
                  all = moveSegment(particles, common, s) && all;
                }
                if (!all) kept = false;
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

/// Finds the motion of the slots of a segment, and a box around it. \return whether it is allowed.
bool Allowance::moveSegment(const ParticleView& particles, const Vec3& common, std::int32_t s) {
  const std::int32_t at = s * kSegment;
  const std::int32_t count = std::min(kSegment, static_cast<std::int32_t>(slots_.size()) - at);
  const auto move = [&](int axis, const double* x, const ScalarArray& from, const ScalarArray& low,
                        const ScalarArray& high, ScalarArray& moved) {
    const AxisMotion motion{x + at, from.data() + at, low.data() + at, high.data() + at,
                            moved.data() + at};
    return moveAxis(motion, common[axis], count, segments_[s].low[axis], segments_[s].high[axis]);
  };
  const bool x = move(0, particles.x, from_.x, low_.x, high_.x, moved_.x);
  const bool y = move(1, particles.y, from_.y, low_.y, high_.y, moved_.y);
  const bool z = move(2, particles.z, from_.z, low_.z, high_.z, moved_.z);
  return x && y && z;
}

/// Whether the gradients of the faces of a patch are where they may be. The edges of all change by
/// no more than the diagonal of a box around the motion of all corners.
bool Allowance::isTurnKept(const Patch& patch) const {
  Box box;
  for (const std::int32_t segment : patch.segments) box.add(segments_[segment]);
  if (2.0 * (box.high - box.low).squaredNorm() <= patch.turn) return true;
  for (std::int32_t k = patch.firstFace; k < patch.lastFace; ++k) {
    if (!isTurnKept(patchFaces_[k])) return false;
  }
  return true;
}

/// Whether the gradient of a face is where it may be.
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
/// gradient that is not.
void Allowance::findLeft() {
  leftVertices_.clear();
  leftFaces_.clear();
  for (std::size_t v = 0; v < slots_.size(); ++v) {
    if (motions_[v].contains(moved_.at(static_cast<std::size_t>(slots_[v])))) continue;
    leftVertices_.push_back(static_cast<VertexId>(v));
    leftFaces_.insert(leftFaces_.end(), facesAround_.begin() + aroundStart_[v],
                      facesAround_.begin() + aroundStart_[v + 1]);
  }
  std::mutex mutex;
  parallelFor(static_cast<std::int32_t>(faces_.size()), kFaceGrain,
              [&](std::int32_t first, std::int32_t last) {
                std::vector<FaceId> found;
                for (FaceId f = first; f < last; ++f) {
                  if (!isTurnKept(f)) found.push_back(f);
                }
                const std::lock_guard<std::mutex> lock(mutex);
                leftFaces_.insert(leftFaces_.end(), found.begin(), found.end());
              });
  std::sort(leftFaces_.begin(), leftFaces_.end());
  leftFaces_.erase(std::unique(leftFaces_.begin(), leftFaces_.end()), leftFaces_.end());
}

bool Allowance::renewLeft(const std::vector<Vec3>& start, const std::vector<Vec3>& end) {
  findLeft();
  const auto all = static_cast<double>(faces_.size());
  renewed_ += static_cast<std::int64_t>(leftFaces_.size());
  if (static_cast<double>(leftFaces_.size()) > kFew * all) return false;
  if (static_cast<double>(renewed_) > kMostRenewed * all) return false;
  const Vec3 before = meanMotion([&](std::size_t v) -> Vec3 { return start[v] - origin_[v]; });
  const Vec3 common = meanMotion([&](std::size_t v) -> Vec3 { return end[v] - start[v]; });
  for (const VertexId v : leftVertices_) {
    allowMotion(static_cast<std::size_t>(v), start[v] - origin_[v] - before,
                end[v] - start[v] - common, common);
    setSlot(v);
  }
  for (const FaceId f : leftFaces_) {
    allowTurn(f, start, end);
    // The centre of the ball is no longer the gradient at the origin: there is no quick check.
    turn_[f] = -1.0;
    patches_[patchOf_[f]].turn = -1.0;
  }
  return true;
}

}  // namespace cloth_sim
