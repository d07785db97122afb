#include "cloth_sim/mesh/face_edges.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace cloth_sim {
namespace {

/// Calls `visit(lower, edge)` for the edges of all faces, face by face.
template <typename Visit>
void forEachEdge(const std::vector<Face>& faces, const Visit& visit) {
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Face& face = faces[f];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [lower, upper] = std::minmax(face[k], face[(k + 1) % 3]);
      visit(lower, FaceEdges::Edge{upper, face[(k + 2) % 3], static_cast<FaceId>(f)});
    }
  }
}

}  // namespace

FaceEdges sortEdges(const std::vector<Face>& faces, std::size_t vertices) {
  using Edge = FaceEdges::Edge;
  FaceEdges result;
  result.first.assign(vertices + 1, 0);
  forEachEdge(faces, [&](VertexId lower, const Edge&) { ++result.first[lower + 1]; });
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  std::vector<std::size_t> next = result.first;
  result.edges.resize(3 * faces.size());
  forEachEdge(faces, [&](VertexId lower, const Edge& edge) { result.edges[next[lower]++] = edge; });
  const auto at = [&](std::size_t k) { return result.edges.begin() + static_cast<long>(k); };
  for (std::size_t v = 0; v < vertices; ++v) {
    std::sort(at(result.first[v]), at(result.first[v + 1]), [](const Edge& p, const Edge& q) {
      return std::tie(p.upper, p.face) < std::tie(q.upper, q.face);
    });
  }
  return result;
}

std::vector<std::array<VertexId, 2>> borderEdges(const FaceEdges& sorted) {
  std::vector<std::array<VertexId, 2>> border;
  for (std::size_t v = 0; v + 1 < sorted.first.size(); ++v) {
    const std::size_t end = sorted.first[v + 1];
    for (std::size_t k = sorted.first[v]; k < end; ++k) {
      const VertexId upper = sorted.edges[k].upper;
      const bool isShared = k + 1 < end && sorted.edges[k + 1].upper == upper;
      if (isShared) {
        ++k;
      } else {
        border.push_back({static_cast<VertexId>(v), upper});
      }
    }
  }
  return border;
}

}  // namespace cloth_sim
