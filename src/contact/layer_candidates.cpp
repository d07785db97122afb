#include "layer_candidates.h"

#include <algorithm>

#include "closest_lanes.h"
#include "support/vector_clones.h"

namespace cloth_sim {
namespace {

/// Substeps after which closest points are found again.
constexpr int kFindEvery = 6;
/// Beyond any sum of the travel [m].
constexpr double kNever = 1e300;
/// Candidates that are looked at together: a multiple of the lanes.
constexpr std::int32_t kLaneBlock = 256;

/// Consecutive candidates, `count` of them, of the same kind.
struct CandidateBlock {
  const std::array<VertexId, 4>* v;
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

/// Vertices of four candidates: first those of the first corner.
struct LaneCorners {
  std::int32_t at[4][kLanes];

  [[gnu::always_inline]] inline explicit LaneCorners(const std::array<VertexId, 4>* v) {
    for (std::int32_t lane = 0; lane < kLanes; ++lane) {
      for (std::size_t i = 0; i < 4; ++i) at[i][lane] = v[lane][i];
    }
  }
  [[gnu::always_inline]] inline Lanes sumOf(const double* values) const {
    return gather(values, at[0]) + gather(values, at[1]) + gather(values, at[2]) +
           gather(values, at[3]);
  }
};

/// Finds the closest points of those candidates of a block that are due.
template <typename Closest>
[[gnu::always_inline]] inline void findInBlock(const CandidateBlock& block,
                                               const CandidateMotion& motion,
                                               const Closest& closest, BlockPoints& points) {
  for (std::int32_t k = 0; k < block.count; k += kLanes) {
    std::uint8_t* const isDue = points.isDue.data() + k;
    for (std::int32_t lane = 0; lane < kLanes; ++lane) isDue[lane] = 0;
    Lanes& due = lanesAt(block.due + k);
    const auto mayBe = due <= motion.farthest;
    if ((mayBe[0] | mayBe[1] | mayBe[2] | mayBe[3]) == 0) continue;
    const LaneCorners v(block.v + k);
    const Lanes ahead = v.sumOf(motion.outlook);
    const auto was = due <= ahead;
    if ((was[0] | was[1] | was[2] | was[3]) == 0) continue;
    std::array<Lanes3, 4> at;
    for (std::size_t i = 0; i < 4; ++i) at[i] = gather(motion.x, v.at[i]);
    const ClosestLanes found = closest(at);
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

CLOTH_SIM_VECTOR_CLONES
void findInBlockOfEdges(const CandidateBlock& block, const CandidateMotion& motion,
                        BlockPoints& points) {
  findInBlock(
      block, motion, [](const std::array<Lanes3, 4>& at) __attribute__((always_inline)) {
        return closestOnSegments(at);
      },
      points);
}

CLOTH_SIM_VECTOR_CLONES
void findInBlockOfFaces(const CandidateBlock& block, const CandidateMotion& motion,
                        BlockPoints& points) {
  findInBlock(
      block, motion, [](const std::array<Lanes3, 4>& at) __attribute__((always_inline)) {
        return closestOnTriangles(at);
      },
      points);
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
  v.clear();
  face.clear();
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
  edgeOwner_.resize(corners_.size());
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    const Face& face = corners_[f];
    for (int k = 0; k < 3; ++k) {
      const std::array<FaceId, 2> on = mesh.facesOnEdge(face[k], face[(k + 1) % 3]);
      edgeOwner_[f][k] = on[1] == kNone ? on[0] : std::min(on[0], on[1]);
    }
  }
  clear();
}

void LayerCandidates::clear() {
  faces_.clear();
  edges_.clear();
  found_.clear();
  std::fill(travel_.begin(), travel_.end(), 0.0);
  sinceFound_ = 0;
}

/// Lists what may come into contact of a pair of faces. A vertex takes part as a corner of its
/// first face, an edge as a side of its first face; so no contact is listed twice.
/// \param isKnown  whether only contacts of vertices with the mark `isMoved_` are missing.
void LayerCandidates::addPair(const FaceIds& ids, bool isKnown,
                              const std::vector<QuickBox>& boxes) {
  const Face& f = corners_[ids.first];
  const Face& g = corners_[ids.second];
  const auto isMoved = [this](VertexId v) { return isMoved_[v] != 0; };
  const auto isMissing = [&](const std::array<VertexId, 4>& v) {
    return !isKnown || std::any_of(v.begin(), v.end(), isMoved);
  };
  const auto join = [&](VertexId a, VertexId b) {
    QuickBox box = boxes[a];
    box.add(boxes[b]);
    return box;
  };
  const auto addVertices = [&](FaceId from, const Face& corners, FaceId to, const Face& face) {
    QuickBox box = join(face[0], face[1]);
    box.add(boxes[face[2]]);
    for (const VertexId p : corners) {
      if (firstFace_[p] != from || contains(face, p) || !box.meets(boxes[p])) continue;
      const std::array<VertexId, 4> v{p, face[0], face[1], face[2]};
      if (!isMissing(v)) continue;
      faces_.v.push_back(v);
      faces_.face.push_back(to);
    }
  };
  addVertices(ids.first, f, ids.second, g);
  addVertices(ids.second, g, ids.first, f);
  for (int i = 0; i < 3; ++i) {
    if (edgeOwner_[ids.first][i] != ids.first) continue;
    const QuickBox edge = join(f[i], f[(i + 1) % 3]);
    for (int j = 0; j < 3; ++j) {
      if (edgeOwner_[ids.second][j] != ids.second) continue;
      const std::array<VertexId, 4> v{f[i], f[(i + 1) % 3], g[j], g[(j + 1) % 3]};
      if (v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3]) continue;
      if (edge.meets(join(v[2], v[3])) && isMissing(v)) edges_.v.push_back(v);
    }
  }
}

void LayerCandidates::extend(const std::vector<FaceIds>& near, std::size_t known,
                             const Renewed& moved, const std::vector<QuickBox>& boxes) {
  for (const VertexId v : moved.vertices) isMoved_[v] = 1;
  for (const FaceId f : moved.faces) isMovedFace_[f] = 1;
  for (std::size_t k = 0; k < known && !moved.vertices.empty(); ++k) {
    if ((isMovedFace_[near[k].first] | isMovedFace_[near[k].second]) == 0) continue;
    addPair(near[k], true, boxes);
  }
  for (const FaceId f : moved.faces) isMovedFace_[f] = 0;
  for (const VertexId v : moved.vertices) isMoved_[v] = 0;
  for (std::size_t k = known; k < near.size(); ++k) addPair(near[k], false, boxes);
  for (List* list : {&faces_, &edges_}) list->due.resize(list->v.size(), -kNever);
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
    // At one and a half times the speed, and a little.
    outlook_[v] = travel_[v] + 1.5 * kFindEvery * step_[v] + 2.5e-5;
    farthest = std::max(farthest, outlook_[v]);
    start_.set(static_cast<std::size_t>(v), motion.start[v]);
  }
  found_.clear();
  findDue(faces_, 4.0 * farthest);
  findDue(edges_, 4.0 * farthest);
}

/// Appends the closest points of a candidate; of edges, only points inside both: their ends are
/// left to vertices and faces. \param at  its place in the block.
template <typename Points>
void LayerCandidates::addFound(const List& list, std::size_t k, const Points& points,
                               std::size_t at) {
  ClosestPoints closest;
  closest.v = list.v[k];
  for (std::size_t i = 0; i < 4; ++i) closest.weight[i] = points.weight[i][at];
  closest.face = list.face.empty() ? kNone : list.face[k];
  closest.apart = points.apart[at];
  if (!closest.areEdges() || closest.areInside()) found_.push_back(closest);
}

/// Appends the closest points of the candidates that are due.
void LayerCandidates::findDue(List& list, double farthest) {
  // The last group of lanes is filled up with the last candidate.
  const std::size_t count = list.due.size();
  while (list.v.size() % kLanes != 0) list.v.push_back(list.v.back());
  list.due.resize(list.v.size(), kNever);
  const CandidateMotion motion{axesAt(std::as_const(start_), 0), travel_.data(), outlook_.data(),
                               halfThickness_.data(), farthest};
  BlockPoints points;
  for (std::size_t first = 0; first < count; first += kLaneBlock) {
    const std::size_t last = std::min(count, first + kLaneBlock);
    const CandidateBlock block{list.v.data() + first, list.due.data() + first,
                               static_cast<std::int32_t>(last - first)};
    if (list.face.empty()) {
      findInBlockOfEdges(block, motion, points);
    } else {
      findInBlockOfFaces(block, motion, points);
    }
    for (std::size_t k = first; k < last; ++k) {
      if (points.isDue[k - first] != 0) addFound(list, k, points, k - first);
    }
  }
  list.v.resize(count);
  list.due.resize(count);
}

}  // namespace cloth_sim
