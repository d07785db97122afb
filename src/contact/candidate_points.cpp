#include "candidate_points.h"

#include <algorithm>

#include "closest_lanes.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

/// Beyond any sum of the travel [m].
constexpr double kNever = 1e300;
/// Candidates that are looked at together: a multiple of the lanes.
constexpr std::int32_t kLaneBlock = 256;

/// Consecutive candidates, `count` of them, of the same kind.
struct CandidateBlock {
  const CandidateIds* ids;
  double* due;  ///< from which sum of the travel they may touch; to be brought up to date [m]
  std::int32_t count;
};

/// Closest points of a block.
struct BlockPoints {
  std::array<std::array<double, kLaneBlock>, 4> weight;
  std::array<double, kLaneBlock> apart;        ///< [m]
  std::array<std::uint8_t, kLaneBlock> isDue;  ///< 1 for those that may touch before the next time
};

/// Candidates that are a vertex and a face.
struct FaceKind {
  const std::vector<Face>& corners;  ///< by face

  std::array<VertexId, 4> cornersOf(const CandidateIds& ids) const {
    const Face& face = corners[ids[1]];
    return {ids[0], face[0], face[1], face[2]};
  }
  bool mayTouch(const CandidateIds& /*ids*/) const { return true; }
  static bool counts(const ClosestPoints& /*closest*/) { return true; }
  static FaceId faceOf(const CandidateIds& ids) { return ids[1]; }
  [[gnu::always_inline]] inline ClosestLanes closest(const std::array<Lanes3, 4>& at) const {
    return closestOnTriangles(at);
  }
};

/// Candidates that are two edges.
struct EdgeKind {
  const Ridges& ridges;

  std::array<VertexId, 4> cornersOf(const CandidateIds& ids) const {
    const std::array<VertexId, 2>& a = ridges[ids[0]].end;
    const std::array<VertexId, 2>& b = ridges[ids[1]].end;
    return {a[0], a[1], b[0], b[1]};
  }
  bool mayTouch(const CandidateIds& ids) const {
    return ridges.isFolded(ids[0]) || ridges.isFolded(ids[1]);
  }
  /// Ends of edges are left to vertices and faces.
  static bool counts(const ClosestPoints& closest) { return closest.areInside(); }
  static FaceId faceOf(const CandidateIds& /*ids*/) { return kNone; }
  [[gnu::always_inline]] inline ClosestLanes closest(const std::array<Lanes3, 4>& at) const {
    return closestOnSegments(at);
  }
};

/// Vertices of four candidates: first those of the first corner.
struct LaneCorners {
  std::int32_t at[4][kLanes];

  template <typename Kind>
  [[gnu::always_inline]] inline LaneCorners(const CandidateIds* ids, const Kind& kind) {
    for (std::int32_t lane = 0; lane < kLanes; ++lane) {
      const std::array<VertexId, 4> v = kind.cornersOf(ids[lane]);
      for (std::size_t i = 0; i < 4; ++i) at[i][lane] = v[i];
    }
  }
  [[gnu::always_inline]] inline Lanes sumOf(const double* values) const {
    return gather(values, at[0]) + gather(values, at[1]) + gather(values, at[2]) +
           gather(values, at[3]);
  }
};

/// Finds the closest points of those candidates of a block that are due.
template <typename Kind>
[[gnu::always_inline]] inline void findInLanes(const CandidateBlock& block,
                                               const CandidateMotion& motion, const Kind& kind,
                                               BlockPoints& points) {
  for (std::int32_t k = 0; k < block.count; k += kLanes) {
    std::uint8_t* const isDue = points.isDue.data() + k;
    for (std::int32_t lane = 0; lane < kLanes; ++lane) isDue[lane] = 0;
    Lanes& due = lanesAt(block.due + k);
    const auto mayBe = due <= 4.0 * motion.farthest;
    if ((mayBe[0] | mayBe[1] | mayBe[2] | mayBe[3]) == 0) continue;
    const LaneCorners v(block.ids + k, kind);
    const Lanes ahead = v.sumOf(motion.outlook);
    auto was = due <= ahead;
    for (std::int32_t lane = 0; lane < kLanes; ++lane) {
      if (was[lane] != 0 && !kind.mayTouch(block.ids[k + lane])) was[lane] = 0;
    }
    if ((was[0] | was[1] | was[2] | was[3]) == 0) continue;
    std::array<Lanes3, 4> at;
    for (std::size_t i = 0; i < 4; ++i) at[i] = gather(motion.x, v.at[i]);
    const ClosestLanes found = kind.closest(at);
    const Lanes apart = sqrt(found.square);
    const Lanes thickness =
        gather(motion.halfThickness, v.at[0]) + gather(motion.halfThickness, v.at[3]);
    due = was ? v.sumOf(motion.travel) + apart - thickness : due;
    const auto is = was & (due <= ahead);
    for (std::size_t i = 0; i < 4; ++i) lanesAt(points.weight[i].data() + k) = found.weight[i];
    lanesAt(points.apart.data() + k) = apart;
    for (std::int32_t lane = 0; lane < kLanes; ++lane) isDue[lane] = is[lane] != 0 ? 1 : 0;
  }
}

// Not templates: GCC makes no clones of those.
CLOTH_SIM_VECTOR_CLONES
void findInBlock(const CandidateBlock& block, const CandidateMotion& motion, const FaceKind& kind,
                 BlockPoints& points) {
  findInLanes(block, motion, kind, points);
}
CLOTH_SIM_VECTOR_CLONES
void findInBlock(const CandidateBlock& block, const CandidateMotion& motion, const EdgeKind& kind,
                 BlockPoints& points) {
  findInLanes(block, motion, kind, points);
}

ClosestPoints pointsOf(const BlockPoints& points, std::size_t at) {
  ClosestPoints closest;
  for (std::size_t i = 0; i < 4; ++i) closest.weight[i] = points.weight[i][at];
  closest.apart = points.apart[at];
  return closest;
}

/// Appends the closest points of the candidates that may touch before the next time.
template <typename Kind>
void findDue(CandidateList& list, const CandidateMotion& motion, const Kind& kind,
             std::vector<ClosestPoints>& found) {
  // The last group of lanes is filled up with the last candidate.
  const std::size_t count = list.due.size();
  while (list.ids.size() % kLanes != 0) list.ids.push_back(list.ids.back());
  list.due.resize(list.ids.size(), kNever);
  BlockPoints points;
  for (std::size_t first = 0; first < count; first += kLaneBlock) {
    const std::size_t last = std::min<std::size_t>(count, first + kLaneBlock);
    findInBlock(
        {list.ids.data() + first, list.due.data() + first, static_cast<std::int32_t>(last - first)},
        motion, kind, points);
    for (std::size_t k = first; k < last; ++k) {
      if (points.isDue[k - first] == 0) continue;
      ClosestPoints closest = pointsOf(points, k - first);
      closest.v = kind.cornersOf(list.ids[k]);
      closest.face = Kind::faceOf(list.ids[k]);
      if (Kind::counts(closest)) found.push_back(closest);
    }
  }
  list.ids.resize(count);
  list.due.resize(count);
}

}  // namespace

void CandidateList::clear() {
  ids.clear();
  due.clear();
}

void CandidateList::add(const CandidateIds& candidate) {
  ids.push_back(candidate);
  due.push_back(-kNever);
}

void findClosest(CandidateList& list, const CandidateMotion& motion,
                 const std::vector<Face>& corners, std::vector<ClosestPoints>& found) {
  findDue(list, motion, FaceKind{corners}, found);
}

void findClosest(CandidateList& list, const CandidateMotion& motion, const Ridges& ridges,
                 std::vector<ClosestPoints>& found) {
  findDue(list, motion, EdgeKind{ridges}, found);
}

}  // namespace cloth_sim
