#include "cloth_sim/cloth/model.h"

namespace cloth_sim {
namespace {

/// Allocates masses and areal densities unless they belong to this revision of the mesh already.
void allocateMasses(Model& model) {
  const auto count = static_cast<std::size_t>(model.particleCount());
  const bool fits = model.mass.size() == count && model.mass.revision() == model.mesh.revision();
  if (fits) return;
  model.arealDensity = VertexData<double>(count, 0.0, model.mesh.revision());
  model.mass = VertexData<double>(count, 0.0, model.mesh.revision());
}

}  // namespace

void lumpMasses(double arealDensity, std::size_t cloth, Model& model) {
  allocateMasses(model);
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    if (model.clothOf(v) != cloth) continue;
    model.arealDensity[v] = arealDensity;
    model.mass[v] = arealDensity * areaAround(model.mesh, v) / 3.0;
  }
}

void lumpMasses(double arealDensity, Model& model) { lumpMasses(arealDensity, 0, model); }

void setParticleMasses(double particleMass, std::size_t cloth, Model& model) {
  allocateMasses(model);
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    if (model.clothOf(v) != cloth) continue;
    model.mass[v] = particleMass;
    model.arealDensity[v] = 3.0 * particleMass / areaAround(model.mesh, v);
  }
}

SpringChanges Model::applyChanges(const MeshChanges& changes) {
  applyMassChanges(changes, *this);
  bending.applyChanges(mesh, changes);
  return springs.applyChanges(mesh, changes);
}

void applyMassChanges(const MeshChanges& changes, Model& model) {
  std::vector<double> before(model.cloths.size(), 0.0);
  std::vector<double> after(model.cloths.size(), 0.0);
  const auto known = static_cast<VertexId>(model.mass.size());
  for (VertexId v : changes.touched) {
    if (v < known) before[model.clothOf(v)] += model.mass[v];
  }
  model.mass.applyChanges(changes);
  model.arealDensity.applyChanges(changes);
  for (VertexId v : changes.touched) {
    model.mass[v] = model.arealDensity[v] * areaAround(model.mesh, v) / 3.0;
    after[model.clothOf(v)] += model.mass[v];
  }
  // Where neighbours differ in density, interpolated densities do not conserve the sum: rescale.
  for (VertexId v : changes.touched) {
    const std::size_t cloth = model.clothOf(v);
    const double ratio = before[cloth] / after[cloth];
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
