#include "layer_candidates.h"

#include <algorithm>

#include "closest_lanes.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

/// Substeps after which closest points are found again.
constexpr int kFindEvery = 6;
/// Motion that is expected until then: so many times that of a substep, at one and a half times its
/// speed.
constexpr double kAhead = 1.5 * kFindEvery;
/// The same of a vertex at rest [m].
constexpr double kLeastAhead = 2.5e-5;
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

/// Per vertex, for all candidates.
struct CandidateMotion {
  ConstAxes x;                  ///< positions [m]
  const double* travel;         ///< [m]
  const double* outlook;        ///< [m]
  const double* halfThickness;  ///< [m]
  double farthest;              ///< largest sum of the outlooks of four vertices [m]
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
    const auto mayBe = due <= motion.farthest;
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

/// Motion that vertices have in common, which brings nothing together [m]: their mean, or none if
/// most are at rest.
Vec3 commonMotion(const SubstepMotion& motion) {
  const Vec3 mean = meanMotion(motion);
  double toMean = 0.0;
  double toRest = 0.0;
  for (const VertexId v : motion.vertices) {
    const Vec3 moved = motion.end[v] - motion.start[v];
    toMean += (moved - mean).norm();
    toRest += moved.norm();
  }
  return toMean < toRest ? mean : Vec3(Vec3::Zero());
}

}  // namespace

void LayerCandidates::List::clear() {
  ids.clear();
  due.clear();
}

void LayerCandidates::build(const Model& model, const std::vector<double>& thickness) {
  const TriangleMesh& mesh = model.mesh;
  const auto vertices = static_cast<std::size_t>(mesh.vertexCount());
  corners_ = mesh.faces();
  isMoved_.assign(vertices, 0);
  isMovedFace_.assign(corners_.size(), 0);
  start_.resize(vertices);
  step_.assign(vertices, 0.0);
  travel_.resize(vertices);
  outlook_.assign(vertices, 0.0);
  halfThickness_.resize(vertices);
  firstFace_.resize(vertices);
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
    firstFace_[v] = *mesh.facesAround(v).begin();
    halfThickness_[v] = 0.5 * thickness[model.clothOf(v)];
  }
  ridges_.build(mesh);
  clear();
}

void LayerCandidates::clear() {
  faces_.clear();
  edges_.clear();
  ridges_.clear();
  found_.clear();
  std::fill(travel_.begin(), travel_.end(), 0.0);
  sinceFound_ = 0;
}

/// Lists what may come into contact of a pair of faces. A vertex takes part as a corner of its
/// first face, an edge as a side of its first face; so no contact is listed twice.
/// \param isKnown  whether only contacts of vertices with the mark `isMoved_` are missing.
void LayerCandidates::addPair(const FaceIds& ids, bool isKnown, const SearchBoxes& boxes) {
  const Face& f = corners_[ids.first];
  const Face& g = corners_[ids.second];
  const auto isMoved = [this](VertexId v) { return isMoved_[v] != 0; };
  const auto isMissing = [&](const std::array<VertexId, 4>& v) {
    return !isKnown || std::any_of(v.begin(), v.end(), isMoved);
  };
  const auto join = [&](VertexId a, VertexId b) {
    QuickBox box = boxes.corners[a];
    box.add(boxes.corners[b]);
    return box;
  };
  const auto addVertices = [&](FaceId from, const Face& corners, FaceId to, const Face& face) {
    const QuickBox& box = boxes.faces[to];
    for (const VertexId p : corners) {
      if (firstFace_[p] != from || contains(face, p) || !box.meets(boxes.corners[p])) continue;
      if (isMissing({p, face[0], face[1], face[2]})) faces_.ids.push_back({p, to});
    }
  };
  addVertices(ids.first, f, ids.second, g);
  addVertices(ids.second, g, ids.first, f);
  for (const Ridges::EdgeId first : ridges_.ownedBy(ids.first)) {
    if (first == kNone) continue;
    const std::array<VertexId, 2>& a = ridges_[first].end;
    const QuickBox edge = join(a[0], a[1]);
    for (const Ridges::EdgeId second : ridges_.ownedBy(ids.second)) {
      if (second == kNone) continue;
      const std::array<VertexId, 2>& b = ridges_[second].end;
      if (a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1]) continue;
      if (!edge.meets(join(b[0], b[1])) || !isMissing({a[0], a[1], b[0], b[1]})) continue;
      edges_.ids.push_back({first, second});
      ridges_.watch(first);
      ridges_.watch(second);
    }
  }
}

void LayerCandidates::extend(const std::vector<FaceIds>& near, std::size_t known,
                             const Renewed& moved, const SearchBoxes& boxes) {
  for (const VertexId v : moved.vertices) isMoved_[v] = 1;
  for (const FaceId f : moved.faces) isMovedFace_[f] = 1;
  for (std::size_t k = 0; k < known && !moved.vertices.empty(); ++k) {
    if ((isMovedFace_[near[k].first] | isMovedFace_[near[k].second]) == 0) continue;
    addPair(near[k], true, boxes);
  }
  for (const FaceId f : moved.faces) isMovedFace_[f] = 0;
  for (const VertexId v : moved.vertices) isMoved_[v] = 0;
  for (std::size_t k = known; k < near.size(); ++k) addPair(near[k], false, boxes);
  for (List* list : {&faces_, &edges_}) list->due.resize(list->ids.size(), -kNever);
}

bool LayerCandidates::follow(const SubstepMotion& motion) {
  const Vec3 common = commonMotion(motion);
  for (const VertexId v : motion.vertices) {
    step_[v] = (motion.end[v] - motion.start[v] - common).norm();
  }
  const bool find = sinceFound_++ % kFindEvery == 0;
  if (find) findClosest(motion);
  for (const VertexId v : motion.vertices) travel_[v] += step_[v];
  return find;
}

void LayerCandidates::findClosest(const SubstepMotion& motion) {
  double farthest = 0.0;
  for (const VertexId v : motion.vertices) {
    outlook_[v] = travel_[v] + kAhead * step_[v] + kLeastAhead;
    farthest = std::max(farthest, outlook_[v]);
    start_.set(static_cast<std::size_t>(v), motion.start[v]);
  }
  found_.clear();
  ridges_.follow(motion, halfThickness_, kAhead);
  findDue(faces_, 4.0 * farthest, FaceKind{corners_});
  findDue(edges_, 4.0 * farthest, EdgeKind{ridges_});
}

/// Appends the closest points of the candidates that are due.
template <typename Kind>
void LayerCandidates::findDue(List& list, double farthest, const Kind& kind) {
  // The last group of lanes is filled up with the last candidate.
  const std::size_t count = list.due.size();
  while (list.ids.size() % kLanes != 0) list.ids.push_back(list.ids.back());
  list.due.resize(list.ids.size(), kNever);
  const CandidateMotion motion{axesAt(std::as_const(start_), 0), travel_.data(), outlook_.data(),
                               halfThickness_.data(), farthest};
  BlockPoints points;
  for (std::size_t first = 0; first < count; first += kLaneBlock) {
    const std::size_t last = std::min(count, first + kLaneBlock);
    findInBlock(
        {list.ids.data() + first, list.due.data() + first, static_cast<std::int32_t>(last - first)},
        motion, kind, points);
    for (std::size_t k = first; k < last; ++k) {
      if (points.isDue[k - first] == 0) continue;
      ClosestPoints closest = pointsOf(points, k - first);
      closest.v = kind.cornersOf(list.ids[k]);
      closest.face = Kind::faceOf(list.ids[k]);
      if (Kind::counts(closest)) found_.push_back(closest);
    }
  }
  list.ids.resize(count);
  list.due.resize(count);
}

}  // namespace cloth_sim
