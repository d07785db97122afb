#include "ridges.h"

#include <cmath>

namespace cloth_sim {
namespace {

/// The distance of the corner of one face beside an edge from the plane of the other [m].
double offPlane(const Ridges::Edge& edge, const std::vector<Vec3>& x) {
  const Vec3& from = x[edge.end[0]];
  const Vec3 normal = (x[edge.end[1]] - from).cross(x[edge.wing[0]] - from);
  return normal.dot(x[edge.wing[1]] - from) / normal.norm();
}

}  // namespace

void Ridges::build(const TriangleMesh& mesh) {
  edges_.clear();
  ownedBy_.assign(static_cast<std::size_t>(mesh.faceCount()), {kNone, kNone, kNone});
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    const Face& face = mesh.faces()[f];
    for (int k = 0; k < 3; ++k) {
      const VertexId a = face[k];
      const VertexId b = face[(k + 1) % 3];
      const std::array<FaceId, 2> on = mesh.facesOnEdge(a, b);
      const FaceId other = on[0] == f ? on[1] : on[0];
      if (other != kNone && other < f) continue;
      const VertexId beyond = other == kNone ? kNone : mesh.oppositeVertex(other, a, b);
      ownedBy_[f][k] = static_cast<EdgeId>(edges_.size());
      edges_.push_back({{a, b}, {face[(k + 2) % 3], beyond}, f});
    }
  }
  count_ = 0;
  loadedFor_.assign(static_cast<std::size_t>(mesh.vertexCount()), count_);
  watched_.clear();
  risen_.clear();
  isFolded_.assign(edges_.size(), 0);
  past_.assign(edges_.size(), Past::kUnwatched);
}

void Ridges::watch(FaceId face) {
  for (const EdgeId edge : ownedBy_[face]) {
    if (edge == kNone || past_[edge] != Past::kUnwatched) continue;
    past_[edge] = Past::kFlat;
    watched_.push_back(edge);
  }
}

void Ridges::clear() {
  for (const EdgeId edge : watched_) past_[edge] = Past::kUnwatched;
  watched_.clear();
  risen_.clear();
}

void Ridges::follow(const SubstepMotion& motion, const std::vector<double>& halfThickness,
                    double ahead) {
  ++count_;
  for (const VertexId v : motion.vertices) loadedFor_[v] = count_;
  for (const EdgeId edge : risen_) past_[edge] = Past::kRidge;
  risen_.clear();
  for (const EdgeId edge : watched_) {
    const double slack = kFlatShare * 2.0 * halfThickness[edges_[edge].end[0]];
    isFolded_[edge] = staysFlat(edges_[edge], motion, slack, ahead) ? 0 : 1;
    if (past_[edge] != Past::kFlat || !isFolded(edge)) continue;
    past_[edge] = Past::kRisen;
    risen_.push_back(edge);
  }
}

/// \param slack  by which a corner may be off the plane [m].
bool Ridges::staysFlat(const Edge& edge, const SubstepMotion& motion, double slack,
                       double ahead) const {
  if (!isLoaded(edge.wing[0]) || !isLoaded(edge.wing[1])) return false;
  const double off = offPlane(edge, motion.start);
  if (!(std::abs(off) <= slack)) return false;
  const double by = offPlane(edge, motion.end) - off;
  return std::abs(off + ahead * by) <= slack;
}

}  // namespace cloth_sim
