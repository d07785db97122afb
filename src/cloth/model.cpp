#include "cloth_sim/cloth/model.h"

namespace cloth_sim {
namespace {

double areaAround(const TriangleMesh& mesh, VertexId v) {
  double area = 0.0;
  for (FaceId f : mesh.facesAround(v)) area += mesh.restArea(f);
  return area;
}

}  // namespace

VertexData<double> lumpedMasses(const TriangleMesh& mesh, double arealDensity) {
  VertexData<double> mass(mesh.vertexCount(), 0.0, mesh.revision());
  for (VertexId v = 0; v < mesh.vertexCount(); ++v) {
    mass[v] = arealDensity * areaAround(mesh, v) / 3.0;
  }
  return mass;
}

void shareMass(const TriangleMesh& mesh, const MeshChanges& changes, VertexData<double>& mass) {
  mass.follow(changes);
  // A copy may have been copied again: going back from the last one, each copy and its source
  // share what the source stood for when the copy was made.
  std::vector<double> area(mesh.vertexCount(), 0.0);
  for (const NewVertex& added : changes.newVertices) {
    for (VertexId v : {added.id, added.from[0]}) area[v] = areaAround(mesh, v);
  }
  std::vector<double> whole = area;
  for (auto added = changes.newVertices.rbegin(); added != changes.newVertices.rend(); ++added) {
    whole[added->from[0]] += whole[added->id];
  }
  for (const NewVertex& added : changes.newVertices) {
    const VertexId source = added.from[0];
    mass[added.id] = mass[source] * (whole[added.id] / whole[source]);
    mass[source] -= mass[added.id];
    whole[source] -= whole[added.id];
  }
}

double totalMass(const Model& model) {
  double total = 0.0;
  for (double m : model.mass) total += m;
  return total;
}

}  // namespace cloth_sim
