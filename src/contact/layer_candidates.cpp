#include "layer_candidates.h"

#include <algorithm>

namespace cloth_sim {
namespace {

/// Substeps after which closest points are found again.
constexpr int kFindEvery = 6;
/// Motion that is expected until then: so many times that of a substep, at one and a half times its
/// speed.
constexpr double kAhead = 1.5 * kFindEvery;
/// The same of a vertex at rest [m].
constexpr double kLeastAhead = 2.5e-5;

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

void LayerCandidates::build(const Model& model, const std::vector<double>& thickness) {
  const TriangleMesh& mesh = model.mesh;
  const auto vertices = static_cast<std::size_t>(mesh.vertexCount());
  corners_ = mesh.faces();
  isMoved_.assign(vertices, 0);
  isMarked_.assign(corners_.size(), 0);
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
  watched_ = 0;
  found_.clear();
  std::fill(travel_.begin(), travel_.end(), 0.0);
  sinceFound_ = 0;
}

/// Lists the vertices of each of two faces near the other one. A vertex takes part as a corner of
/// its first face, so no candidate is listed twice.
/// \param isMissing  by the four vertices of a candidate.
template <typename IsMissing>
void LayerCandidates::listVertices(const FaceIds& ids, const SearchBoxes& boxes,
                                   const IsMissing& isMissing) {
  const auto listCorners = [&](FaceId from, FaceId to) {
    const Face& face = corners_[to];
    const QuickBox& box = boxes.faces[to];
    for (const VertexId p : corners_[from]) {
      if (firstFace_[p] != from || contains(face, p) || !box.meets(boxes.corners[p])) continue;
      if (isMissing({p, face[0], face[1], face[2]})) faces_.add({p, to});
    }
  };
  listCorners(ids.first, ids.second);
  listCorners(ids.second, ids.first);
}

/// Lists edges near each other. An edge takes part as a side of its first face.
/// \param isMissing  by two edges.
template <typename IsMissing>
void LayerCandidates::listEdges(const FaceIds& ids, const SearchBoxes& boxes,
                                const IsMissing& isMissing) {
  const auto boxOf = [&](const std::array<VertexId, 2>& end) {
    QuickBox box = boxes.corners[end[0]];
    box.add(boxes.corners[end[1]]);
    return box;
  };
  for (const Ridges::EdgeId first : ridges_.ownedBy(ids.first)) {
    for (const Ridges::EdgeId second : ridges_.ownedBy(ids.second)) {
      if (first == kNone || second == kNone || !isMissing(first, second)) continue;
      const std::array<VertexId, 2>& a = ridges_[first].end;
      const std::array<VertexId, 2>& b = ridges_[second].end;
      if (a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1]) continue;
      if (boxOf(a).meets(boxOf(b))) edges_.add({first, second});
    }
  }
}

void LayerCandidates::extend(const NearFaces& near, std::size_t known, const Renewed& moved) {
  for (; watched_ < near.faces.size(); ++watched_) ridges_.watch(near.faces[watched_]);
  if (!moved.vertices.empty()) listMoved(near, known, moved);
  const auto isAny = [](const std::array<VertexId, 4>& /*v*/) { return true; };
  const auto isAtRidge = [this](Ridges::EdgeId a, Ridges::EdgeId b) {
    return ridges_.isRidge(a) || ridges_.isRidge(b);
  };
  for (std::size_t k = known; k < near.pairs.size(); ++k) {
    listVertices(near.pairs[k], near.boxes, isAny);
    listEdges(near.pairs[k], near.boxes, isAtRidge);
  }
}

/// Lists candidates of known pairs which have a vertex with a new box: it may meet others.
void LayerCandidates::listMoved(const NearFaces& near, std::size_t known, const Renewed& moved) {
  for (const VertexId v : moved.vertices) isMoved_[v] = 1;
  for (const FaceId f : moved.faces) isMarked_[f] = 1;
  const auto isMoved = [this](VertexId v) { return isMoved_[v] != 0; };
  const auto isVertexMoved = [&](const std::array<VertexId, 4>& v) {
    return std::any_of(v.begin(), v.end(), isMoved);
  };
  const auto isEdgeMoved = [&](Ridges::EdgeId a, Ridges::EdgeId b) {
    if (!ridges_.isRidge(a) && !ridges_.isRidge(b)) return false;
    const std::array<VertexId, 2>& first = ridges_[a].end;
    const std::array<VertexId, 2>& second = ridges_[b].end;
    return isMoved(first[0]) || isMoved(first[1]) || isMoved(second[0]) || isMoved(second[1]);
  };
  for (std::size_t k = 0; k < known; ++k) {
    if ((isMarked_[near.pairs[k].first] | isMarked_[near.pairs[k].second]) == 0) continue;
    listVertices(near.pairs[k], near.boxes, isVertexMoved);
    listEdges(near.pairs[k], near.boxes, isEdgeMoved);
  }
  for (const FaceId f : moved.faces) isMarked_[f] = 0;
  for (const VertexId v : moved.vertices) isMoved_[v] = 0;
}

/// Lists edges near those along which the cloth may be folded for the first time.
void LayerCandidates::listNewRidges(const NearFaces& near) {
  if (ridges_.risen().empty()) return;
  for (const Ridges::EdgeId edge : ridges_.risen()) isMarked_[ridges_[edge].owner] = 1;
  const auto isMissing = [this](Ridges::EdgeId a, Ridges::EdgeId b) {
    const bool isKnown = ridges_.isOldRidge(a) || ridges_.isOldRidge(b);
    return !isKnown && (ridges_.isRisen(a) || ridges_.isRisen(b));
  };
  for (const FaceIds& pair : near.pairs) {
    if ((isMarked_[pair.first] | isMarked_[pair.second]) != 0) {
      listEdges(pair, near.boxes, isMissing);
    }
  }
  for (const Ridges::EdgeId edge : ridges_.risen()) isMarked_[ridges_[edge].owner] = 0;
}

bool LayerCandidates::follow(const SubstepMotion& motion, const NearFaces& near) {
  const Vec3 common = commonMotion(motion);
  for (const VertexId v : motion.vertices) {
    step_[v] = (motion.end[v] - motion.start[v] - common).norm();
  }
  const bool find = sinceFound_++ % kFindEvery == 0;
  if (find) findTouching(motion, near);
  for (const VertexId v : motion.vertices) travel_[v] += step_[v];
  return find;
}

void LayerCandidates::findTouching(const SubstepMotion& motion, const NearFaces& near) {
  double farthest = 0.0;
  for (const VertexId v : motion.vertices) {
    outlook_[v] = travel_[v] + kAhead * step_[v] + kLeastAhead;
    farthest = std::max(farthest, outlook_[v]);
    start_.set(static_cast<std::size_t>(v), motion.start[v]);
  }
  ridges_.follow(motion, halfThickness_, kAhead);
  listNewRidges(near);
  const CandidateMotion ahead{axesAt(std::as_const(start_), 0), travel_.data(), outlook_.data(),
                              halfThickness_.data(), farthest};
  found_.clear();
  findClosest(faces_, ahead, corners_, found_);
  findClosest(edges_, ahead, ridges_, found_);
}

}  // namespace cloth_sim
