#pragma once
/// \file The cloth: everything that is constant during a step.

#include "cloth_sim/cloth/spring_network.h"
#include "cloth_sim/mesh/grid.h"
#include "cloth_sim/mesh/triangle_mesh.h"
#include "cloth_sim/mesh/vertex_data.h"

namespace cloth_sim {

struct Model {
  TriangleMesh mesh;
  SpringNetwork springs;
  VertexData<double> mass;  ///< lumped [kg], > 0
  Fabric fabric;
  std::optional<Grid> grid;  ///< how the mesh came to be, if it was a grid

  std::int32_t particleCount() const { return mesh.vertexCount(); }
};

/// One edit of a model, for everything that keeps data about it.
struct ModelChanges {
  MeshChanges mesh;
  SpringChanges springs;
};

/// A third of the areal density times rest area of every face, to each of its corners [kg].
VertexData<double> lumpedMasses(const TriangleMesh& mesh, double arealDensity);

/// Each vertex that was split shares its mass with its copies in proportion to the rest area
/// around each, so the total is kept whatever it was made of.
void shareMass(const TriangleMesh& mesh, const MeshChanges& changes, VertexData<double>& mass);

/// Summed in ascending order of vertices, so it is the same bits for the same model.
double totalMass(const Model& model);

}  // namespace cloth_sim
