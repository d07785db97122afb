#include "cloth_sim/cloth/model.h"

namespace cloth_sim {

void lumpMasses(double arealDensity, Model& model) {
  const auto count = static_cast<std::size_t>(model.particleCount());
  model.arealDensity = VertexData<double>(count, arealDensity, model.mesh.revision());
  model.mass = VertexData<double>(count, 0.0, model.mesh.revision());
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    model.mass[v] = arealDensity * areaAround(model.mesh, v) / 3.0;
  }
}

void setParticleMasses(double particleMass, Model& model) {
  const auto count = static_cast<std::size_t>(model.particleCount());
  model.mass = VertexData<double>(count, particleMass, model.mesh.revision());
  model.arealDensity = VertexData<double>(count, 0.0, model.mesh.revision());
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    model.arealDensity[v] = 3.0 * particleMass / areaAround(model.mesh, v);
  }
}

void followMasses(const MeshChanges& changes, Model& model) {
  double before = 0.0;
  const auto known = static_cast<VertexId>(model.mass.size());
  for (VertexId v : changes.touched) {
    if (v < known) before += model.mass[v];
  }
  model.mass.follow(changes);
  model.arealDensity.follow(changes);
  double after = 0.0;
  for (VertexId v : changes.touched) {
    model.mass[v] = model.arealDensity[v] * areaAround(model.mesh, v) / 3.0;
    after += model.mass[v];
  }
  if (changes.touched.empty()) return;
  // Where neighbours differ in density, blending it does not keep the sum.
  const double ratio = before / after;
  for (VertexId v : changes.touched) {
    model.mass[v] *= ratio;
    model.arealDensity[v] *= ratio;
  }
}

double totalMass(const Model& model) {
  double total = 0.0;
  for (double m : model.mass) total += m;
  return total;
}

}  // namespace cloth_sim
