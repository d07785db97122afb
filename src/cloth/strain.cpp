#include "cloth_sim/cloth/strain.h"

#include "cloth_sim/cloth/spring.h"

namespace cloth_sim {
namespace {

constexpr double kLeastRest = 1e-6;  ///< rest length that may divide [m]

}  // namespace

std::vector<StrainLine> strainLines(const FaceEdges& sorted, const std::vector<Vec2>& material) {
  std::vector<StrainLine> lines;
  lines.reserve(2 * sorted.edges.size() / 3);
  const auto isBias = [&](VertexId a, VertexId b) {
    return threadDirection(material[b] - material[a]) == ThreadDirection::kBias;
  };
  const auto add = [&](VertexId a, VertexId b) {
    lines.push_back({a, b, std::max(kLeastRest, (material[b] - material[a]).norm())});
  };
  for (std::size_t v = 0; v < material.size(); ++v) {
    const auto lower = static_cast<VertexId>(v);
    for (std::size_t k = sorted.first[v]; k < sorted.first[v + 1]; ++k) {
      const FaceEdges::Edge& edge = sorted.edges[k];
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
