#include "spring_area.h"

#include <cmath>

namespace cloth_sim {
namespace {

/// The corner between the equally long bias edges of a face that an odd number of bisections made
/// of one of a grid; kNone if it is another face.
VertexId biasCorner(const TriangleMesh& mesh, FaceId f) {
  constexpr double kEqualLengths = 1e-9;
  if (mesh.generation(f) == 0) return kNone;
  const Face& face = mesh.face(f);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2& corner = mesh.material(face[k]);
    const Vec2 ahead = mesh.material(face[(k + 1) % 3]) - corner;
    const Vec2 behind = mesh.material(face[(k + 2) % 3]) - corner;
    const bool isCorner = std::abs(ahead.norm() - behind.norm()) <= kEqualLengths * ahead.norm() &&
                          threadDirection(ahead) == ThreadDirection::kBias &&
                          threadDirection(behind) == ThreadDirection::kBias &&
                          threadDirection(ahead - behind) != ThreadDirection::kBias;
    if (isCorner) return face[k];
  }
  return kNone;
}

/// Returns how often the area of a face counts in a spring [-]. A face of a grid has two edges
/// along threads and one bias edge. A face with two bias edges divides itself between these, counts
/// for both threads on its third edge, and has no thread at the corner between them; docs/model.md
/// has the derivation.
double fractionOf(const TriangleMesh& mesh, FaceId f, const Spring& spring) {
  const VertexId corner = biasCorner(mesh, f);
  if (corner == kNone) return 1.0;
  switch (spring.kind) {
    case SpringKind::kStructural:
      return 2.0;
    case SpringKind::kShear:
      return 0.5;
    case SpringKind::kBend:
      return corner == spring.support[0] ? 0.0 : 1.5;
  }
  return 1.0;
}

}  // namespace

double representedArea(const TriangleMesh& mesh, const IndexSpan& faces, const Spring& spring) {
  double area = 0.0;
  double whole = 0.0;
  for (FaceId f : faces) {
    area += fractionOf(mesh, f, spring) * mesh.restArea(f);
    whole += mesh.restArea(f);
  }
  return area > 0.0 ? area : whole;
}

}  // namespace cloth_sim
