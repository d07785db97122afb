#include <utility>

#include "cloth_sim/contact/shapes/box.h"
#include "cloth_sim/contact/shapes/mesh.h"

namespace cloth_sim {

TriangleSurface boxSurface(const Vec3& size) {
  std::vector<Vec3> corners;
  for (int k = 0; k < 8; ++k) {
    const Vec3 side(k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0);
    corners.emplace_back(0.5 * size.cwiseProduct(side));
  }
  return {std::move(corners),
          {{{0, 2, 1}},
           {{1, 2, 3}},
           {{4, 5, 6}},
           {{5, 7, 6}},
           {{0, 1, 4}},
           {{1, 5, 4}},
           {{2, 6, 3}},
           {{3, 6, 7}},
           {{0, 4, 2}},
           {{2, 4, 6}},
           {{1, 3, 5}},
           {{3, 7, 5}}}};
}

std::shared_ptr<const TriangleSurface> BoxShape::sharpSurface() const {
  return sharpEdges ? std::make_shared<const TriangleSurface>(boxSurface(size)) : nullptr;
}

SurfaceFile surfaceFile(std::string name, TriangleSurface surface) {
  const std::uint64_t hash = surface.contentHash();
  return {std::move(name), std::make_shared<const TriangleSurface>(std::move(surface)), hash, ""};
}

const SurfaceFile& defaultSurface() {
  static const SurfaceFile file = surfaceFile("cube", boxSurface(Vec3::Constant(0.2)));
  return file;
}

std::vector<DrawnPart> MeshShape::drawing() const {
  DrawnPart part;
  part.kind = DrawnPart::Kind::kTriangles;
  part.colour = kRoundColour;
  part.surface = file.surface;
  part.size = scale.value_or(Vec3::Ones());
  if (!file.path.empty()) part.resource = "file://" + file.path;
  return {part};
}

std::optional<double> MeshShape::handleRadius() const {
  const double depth = -file.surface->distance(Vec3::Zero());
  if (!(depth > 0.0)) return std::nullopt;
  return depth;
}

}  // namespace cloth_sim
