#include "cloth_sim/cloth/strain.h"

#include <numeric>

#include "cloth_sim/cloth/spring.h"

namespace cloth_sim {
namespace {

constexpr double kLeastRest = 1e-6;  ///< rest length that may divide [m]

/// An edge of a face, listed under its lower vertex.
struct FaceEdge {
  VertexId upper = kNone;     ///< its other end
  VertexId opposite = kNone;  ///< the third vertex of the face
};

/// The edges of all faces: those of vertex v are edges[first[v]] to edges[first[v + 1] - 1], each
/// edge once for each of its faces, one after the other.
struct FaceEdges {
  std::vector<std::size_t> first;
  std::vector<FaceEdge> edges;
};

template <typename Visit>
void forEachEdge(const std::vector<Face>& faces, const Visit& visit) {
  for (const Face& face : faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [lower, upper] = std::minmax(face[k], face[(k + 1) % 3]);
      visit(lower, upper, face[(k + 2) % 3]);
    }
  }
}

FaceEdges sortEdges(const std::vector<Face>& faces, std::size_t vertices) {
  FaceEdges result;
  result.first.assign(vertices + 1, 0);
  forEachEdge(faces, [&](VertexId lower, VertexId, VertexId) { ++result.first[lower + 1]; });
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  std::vector<std::size_t> next = result.first;
  result.edges.resize(3 * faces.size());
  forEachEdge(faces, [&](VertexId lower, VertexId upper, VertexId opposite) {
    result.edges[next[lower]++] = {upper, opposite};
  });
  const auto at = [&](std::size_t k) { return result.edges.begin() + static_cast<long>(k); };
  for (std::size_t v = 0; v < vertices; ++v) {
    std::sort(at(result.first[v]), at(result.first[v + 1]),
              [](const FaceEdge& p, const FaceEdge& q) { return p.upper < q.upper; });
  }
  return result;
}

}  // namespace

std::vector<StrainLine> strainLines(const std::vector<Face>& faces,
                                    const std::vector<Vec2>& material) {
  const FaceEdges sorted = sortEdges(faces, material.size());
  std::vector<StrainLine> lines;
  lines.reserve(2 * faces.size());
  const auto isBias = [&](VertexId a, VertexId b) {
    return threadDirection(material[b] - material[a]) == ThreadDirection::kBias;
  };
  const auto add = [&](VertexId a, VertexId b) {
    lines.push_back({a, b, std::max(kLeastRest, (material[b] - material[a]).norm())});
  };
  for (std::size_t v = 0; v < material.size(); ++v) {
    const auto lower = static_cast<VertexId>(v);
    for (std::size_t k = sorted.first[v]; k < sorted.first[v + 1]; ++k) {
      const FaceEdge& edge = sorted.edges[k];
      const bool isNew = k == sorted.first[v] || sorted.edges[k - 1].upper != edge.upper;
      if (isNew) {
        add(lower, edge.upper);
        continue;
      }
      const VertexId across = sorted.edges[k - 1].opposite;
      if (isBias(lower, edge.upper) && isBias(across, edge.opposite)) add(across, edge.opposite);
    }
  }
  return lines;
}

void vertexStrains(const std::vector<StrainLine>& lines, const std::vector<Vec3>& positions,
                   std::vector<float>& strains) {
  strains.assign(positions.size(), 1.0f);  // squares of stretches, at first
  for (const StrainLine& line : lines) {
    const double length2 = (positions[line.b] - positions[line.a]).squaredNorm();
    const auto stretch2 = static_cast<float>(length2 / (line.restLength * line.restLength));
    strains[line.a] = std::max(strains[line.a], stretch2);
    strains[line.b] = std::max(strains[line.b], stretch2);
  }
  for (float& strain : strains) strain = strainOf(strain);
}

}  // namespace cloth_sim
