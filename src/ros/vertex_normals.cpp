#include "vertex_normals.h"

namespace cloth_sim {

void vertexNormals(const std::vector<Face>& faces, const std::vector<Vec3>& positions,
                   std::vector<Eigen::Vector3f>& normals) {
  normals.assign(positions.size(), Eigen::Vector3f::Zero());
  for (const Face& face : faces) {
    const Eigen::Vector3f normal = areaNormal(face, positions);
    for (const VertexId v : face) normals[v] += normal;
  }
  for (Eigen::Vector3f& normal : normals) normal = unitNormal(normal);
}

}  // namespace cloth_sim
