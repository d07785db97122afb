#include "allowance.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "sampled_motion.h"
#include "support/simd.h"
#include "support/vector_clones.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Faces that are renewed in sum until all are, over the most at a time.
constexpr double kMostRenewed = 5.0;
/// Slots that are compared together.
constexpr std::int32_t kSegment = 16;

constexpr std::int32_t kSegmentGrain = 256;
constexpr std::int32_t kRunGrain = 32;
constexpr std::int32_t kFaceGrain = 2048;
constexpr std::int32_t kVertexGrain = 4096;

/// Motion of consecutive slots since a search.
struct SegmentMotion {
  ConstAxes x;     ///< positions [m]
  ConstAxes from;  ///< positions at the search [m]
  ConstAxes low;   ///< least displacement that is allowed [m]
  ConstAxes high;  ///< largest one [m]
  Axes moved;      ///< displacement, to be set [m]
};

/// Sets the displacements of a segment's slots along an axis against `common` [m]. \return whether
/// all are allowed; false for NaN.
[[gnu::always_inline]] inline bool moveAxis(const double* x, const double* from, const double* low,
                                            const double* high, double common, double* moved) {
  auto kept = lanesAt(low) <= lanesAt(high);  // true in each lane
  for (std::int32_t k = 0; k < kSegment; k += kLanes) {
    const Lanes now = lanesAt(x + k) - lanesAt(from + k) - common;
    lanesAt(moved + k) = now;
    kept &= (now >= lanesAt(low + k)) & (now <= lanesAt(high + k));
  }
  return (kept[0] & kept[1] & kept[2] & kept[3]) != 0;
}

/// Does so for `count` segments along all axes. \return whether all motion is allowed.
CLOTH_SIM_VECTOR_CLONES
bool moveSegments(const SegmentMotion& of, const Vec3& common, std::int32_t count,
                  std::uint8_t* isKept) {
  bool areKept = true;
  for (std::int32_t s = 0; s < count; ++s) {
    const std::int32_t at = s * kSegment;
    bool kept = moveAxis(of.x.x + at, of.from.x + at, of.low.x + at, of.high.x + at, common.x(),
                         of.moved.x + at);
    kept &= moveAxis(of.x.y + at, of.from.y + at, of.low.y + at, of.high.y + at, common.y(),
                     of.moved.y + at);
    kept &= moveAxis(of.x.z + at, of.from.z + at, of.low.z + at, of.high.z + at, common.z(),
                     of.moved.z + at);
    isKept[s] = kept ? 1 : 0;
    areKept &= kept;
  }
  return areKept;
}

}  // namespace

void Allowance::build(const Model& model) {
  const TriangleMesh& mesh = model.mesh;
  faces_ = mesh.faces();
  inverseRest_.resize(faces_.size());
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    inverseRest_[f] = inverseRestOf(mesh, faces_[f]);
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
  balls_.resize(faces_.size());
  edges_.build(mesh);
  hasSlots_ = false;
}

/// \param placeOf  position of a vertex [m].
template <typename PlaceOf>
Gradient Allowance::gradient(FaceId f, const PlaceOf& placeOf) const {
  const Face& face = faces_[f];
  const auto& origin = placeOf(face[0]);
  return Gradient::of(placeOf(face[1]) - origin, placeOf(face[2]) - origin, inverseRest_[f]);
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

/// Sets the gradients that a face may have. \param start, end  its gradients in the substep.
void Allowance::allowTurn(FaceId f, const Gradient& start, const Gradient& end) {
  const double turned = (end - start).norm();
  balls_[f] = {start, std::max(reach_.leastTurn, reach_.substeps * turned)};
}

void Allowance::renew(const std::vector<Vec3>& start, const std::vector<Vec3>& end,
                      const Reach& reach) {
  reach_ = reach;
  origin_ = start;
  renewed_ = 0;
  const Vec3 common =
      sampledMotion(origin_.size(), [&](VertexId v) -> Vec3 { return end[v] - start[v]; });
  parallelForEach(origin_.size(), kVertexGrain, [&](std::int32_t v) {
    allowMotion(static_cast<std::size_t>(v), Vec3::Zero(), end[v] - start[v] - common, common);
  });
  const auto startOf = [&](VertexId v) -> const Vec3& { return start[v]; };
  const auto endOf = [&](VertexId v) -> const Vec3& { return end[v]; };
  parallelForEach(faces_.size(), kFaceGrain,
                  [&](FaceId f) { allowTurn(f, gradient(f, startOf), gradient(f, endOf)); });
}

void Allowance::follow(const ParticleView& particles) {
  const auto vertices = static_cast<VertexId>(slots_.size());
  for (VertexId v = 0; v < vertices; ++v) {
    const std::int32_t slot = particles.slot(v);
    if (slot != slots_[v]) hasSlots_ = false;
    slots_[v] = slot;
  }
  if (!hasSlots_) {
    listSlots();
    edges_.follow(slots_);
  }
  for (VertexId v = 0; v < vertices; ++v) setSlot(v);
  edges_.allow(balls_);
}

bool Allowance::isFollowing(const ParticleView& particles) const {
  for (std::size_t v = 0; v < slots_.size(); ++v) {
    if (particles.slot(static_cast<VertexId>(v)) != slots_[v]) return false;
  }
  return hasSlots_;
}

/// Sizes the arrays of slots. Whatever is in slots without a vertex may go anywhere.
void Allowance::listSlots() {
  const std::int32_t last = slots_.empty() ? -1 : *std::max_element(slots_.begin(), slots_.end());
  vertexIn_.assign(static_cast<std::size_t>(last + 1), kNone);
  for (std::size_t v = 0; v < slots_.size(); ++v) vertexIn_[slots_[v]] = static_cast<VertexId>(v);
  for (VectorArray* array : {&from_, &low_, &high_, &moved_}) array->resize(vertexIn_.size());
  for (std::size_t slot = 0; slot < vertexIn_.size(); ++slot) {
    if (vertexIn_[slot] != kNone) continue;
    from_.set(slot, Vec3::Zero());
    low_.set(slot, Vec3::Constant(-std::numeric_limits<double>::infinity()));
    high_.set(slot, Vec3::Constant(std::numeric_limits<double>::infinity()));
  }
  isSegmentKept_.resize((vertexIn_.size() + kSegment - 1) / kSegment);
  hasSlots_ = true;
}

void Allowance::setSlot(VertexId v) {
  const auto slot = static_cast<std::size_t>(slots_[v]);
  from_.set(slot, origin_[v]);
  low_.set(slot, motions_[v].low);
  high_.set(slot, motions_[v].high);
}

bool Allowance::isKept(const ParticleView& particles) {
  const Vec3 common = sampledMotion(
      origin_.size(), [&](VertexId v) -> Vec3 { return particles.at(slots_[v]) - origin_[v]; });
  std::atomic<bool> kept{true};
  parallelFor(static_cast<std::int32_t>(isSegmentKept_.size()), kSegmentGrain,
              [&](std::int32_t first, std::int32_t last) {
                if (!move(particles, common, first, last)) kept = false;
              });
  parallelFor(edges_.runCount(), kRunGrain, [&](std::int32_t first, std::int32_t last) {
    if (!kept) return;
    if (!edges_.visitChanged(moved_, first, last, [&](FaceId f) { return isTurnKept(f); })) {
      kept = false;
    }
  });
  return kept;
}

/// Finds the motion of the slots of some segments. \return whether it is allowed.
bool Allowance::move(const ParticleView& particles, const Vec3& common, std::int32_t first,
                     std::int32_t last) {
  const auto slots = static_cast<std::int32_t>(vertexIn_.size());
  const std::int32_t whole = std::min(last, slots / kSegment);
  const std::int32_t at = first * kSegment;
  bool kept = true;
  if (whole > first) {
    kept = moveSegments({{particles.x + at, particles.y + at, particles.z + at},
                         axesAt(std::as_const(from_), at),
                         axesAt(std::as_const(low_), at),
                         axesAt(std::as_const(high_), at),
                         axesAt(moved_, at)},
                        common, whole - first, &isSegmentKept_[first]);
  }
  if (whole == last) return kept;
  bool isRestKept = true;
  for (std::int32_t slot = whole * kSegment; slot < slots; ++slot) {
    const auto k = static_cast<std::size_t>(slot);
    const Vec3 moved = particles.at(slot) - from_.at(k) - common;
    moved_.set(k, moved);
    isRestKept = isRestKept && Box{low_.at(k), high_.at(k)}.contains(moved);
  }
  isSegmentKept_[whole] = isRestKept ? 1 : 0;
  return kept && isRestKept;
}

/// Tells whether the gradient of a face is where it may be.
bool Allowance::isTurnKept(FaceId f) const {
  const Face& face = faces_[f];
  const Vec3 moved = moved_.at(static_cast<std::size_t>(slots_[face[0]]));
  const Vec3 first = moved_.at(static_cast<std::size_t>(slots_[face[1]])) - moved;
  const Vec3 second = moved_.at(static_cast<std::size_t>(slots_[face[2]])) - moved;
  const Gradient now = Gradient::of(first + origin_[face[1]] - origin_[face[0]],
                                    second + origin_[face[2]] - origin_[face[0]], inverseRest_[f]);
  return (now - balls_[f].centre).norm() <= balls_[f].radius;
}

/// Lists the vertices that are not where they may be, ascending, and the faces with such a corner.
/// \return whether these are few; if not, the lists are not complete.
bool Allowance::findLeftVertices(std::size_t mostFaces) {
  left_.vertices.clear();
  left_.faces.clear();
  const auto slots = static_cast<std::int32_t>(vertexIn_.size());
  for (std::size_t s = 0; s < isSegmentKept_.size(); ++s) {
    if (isSegmentKept_[s] != 0) continue;
    const std::int32_t first = static_cast<std::int32_t>(s) * kSegment;
    for (std::int32_t slot = first; slot < std::min(first + kSegment, slots); ++slot) {
      const VertexId v = vertexIn_[slot];
      if (v == kNone || motions_[v].contains(moved_.at(static_cast<std::size_t>(slot)))) continue;
      left_.vertices.push_back(v);
      left_.faces.insert(left_.faces.end(), facesAround_.begin() + aroundStart_[v],
                         facesAround_.begin() + aroundStart_[v + 1]);
    }
    if (left_.faces.size() > 2 * mostFaces) return false;  // each is there three times at most
  }
  std::sort(left_.vertices.begin(), left_.vertices.end());
  return true;
}

/// Lists the vertices that are not where they may be, and the faces with such a corner or with a
/// gradient that is not. \return whether these are few; if not, the lists are not complete.
bool Allowance::findLeft(double few) {
  const auto most = static_cast<std::size_t>(few * static_cast<double>(faces_.size()));
  if (!findLeftVertices(most)) return false;
  edges_.visitChanged(moved_, 0, edges_.runCount(), [&](FaceId f) {
    if (!isTurnKept(f)) left_.faces.push_back(f);
    return true;
  });
  std::sort(left_.faces.begin(), left_.faces.end());
  left_.faces.erase(std::unique(left_.faces.begin(), left_.faces.end()), left_.faces.end());
  return left_.faces.size() <= most;
}

bool Allowance::renewLeft(const ParticleView& particles, double few, double most) {
  if (!findLeft(few)) return false;
  renewed_ += static_cast<std::int64_t>(left_.faces.size());
  const double mostRenewed = kMostRenewed * few * static_cast<double>(faces_.size());
  if (static_cast<double>(renewed_) > mostRenewed) return false;
  const auto startOf = [&](VertexId v) { return particles.startAt(slots_[v]); };
  const auto endOf = [&](VertexId v) { return particles.at(slots_[v]); };
  const Vec3 before =
      sampledMotion(origin_.size(), [&](VertexId v) -> Vec3 { return startOf(v) - origin_[v]; });
  const Vec3 common =
      sampledMotion(origin_.size(), [&](VertexId v) -> Vec3 { return endOf(v) - startOf(v); });
  for (const VertexId v : left_.vertices) {
    const Vec3 motion = endOf(v) - startOf(v) - common;
    if (!(motion.norm() <= most)) return false;  // also for NaN
    allowMotion(static_cast<std::size_t>(v), startOf(v) - origin_[v] - before, motion, common);
    setSlot(v);
  }
  for (const FaceId f : left_.faces) {
    allowTurn(f, gradient(f, startOf), gradient(f, endOf));
    edges_.distrust(f);  // the centre of the ball is no longer the gradient at the origin
  }
  return true;
}

}  // namespace cloth_sim
