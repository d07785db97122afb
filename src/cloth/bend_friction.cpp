#include "cloth_sim/cloth/bend_friction.h"

#include <algorithm>

namespace cloth_sim {
namespace {

/// Returns the index of a vertex in an element, which is appended if it is new.
std::size_t indexOf(VertexId v, SlipElement& element) {
  const auto end = element.vertex.begin() + static_cast<std::ptrdiff_t>(element.count);
  const auto at = std::find(element.vertex.begin(), end, v);
  const auto index = static_cast<std::size_t>(at - element.vertex.begin());
  if (at == end) element.vertex[element.count++] = v;
  return index;
}

}  // namespace

SlipElement slipElement(const PlateBending& bending, const TriangleMesh& mesh, FaceId f) {
  SlipElement element;
  element.vertex.fill(kNone);
  element.weight.fill(Vec3::Zero());
  element.stiffness = bending.slipStiffness(f);
  if (element.stiffness == 0.0) return element;
  for (const VertexId v : mesh.face(f)) indexOf(v, element);
  for (std::size_t k = 0; k < PlateBending::kPerFace; ++k) {
    const PlateElement& part =
        bending.elements()[PlateBending::kPerFace * static_cast<std::size_t>(f) + k];
    for (int i = 0; i < part.count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      element.weight[indexOf(part.vertex[at], element)][static_cast<Eigen::Index>(k)] =
          part.weight[at];
    }
  }
  return element;
}

double slipEnergy(const PlateBending& bending, const TriangleMesh& mesh, const std::vector<Vec3>& x,
                  const std::vector<Vec3>& z) {
  double sum = 0.0;
  for (FaceId f = 0; f < mesh.faceCount(); ++f) {
    const SlipElement element = slipElement(bending, mesh, f);
    if (element.count == 0) continue;
    const auto at = [&](VertexId v) { return x[static_cast<std::size_t>(v)]; };
    sum += element.energy(signedCurvature(element, at).value - z[static_cast<std::size_t>(f)]);
  }
  return sum;
}

}  // namespace cloth_sim
