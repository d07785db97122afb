#pragma once
/// \file The cloth: everything that is constant during a step.

#include "cloth_sim/cloth/bend_network.h"
#include "cloth_sim/cloth/spring_network.h"
#include "cloth_sim/mesh/grid.h"
#include "cloth_sim/mesh/triangle_mesh.h"
#include "cloth_sim/mesh/vertex_data.h"

namespace cloth_sim {

struct Model {
  TriangleMesh mesh;
  SpringNetwork springs;
  BendNetwork bending;        ///< empty: bending is none, or of springs
  VertexData<double> mass;  ///< lumped [kg], > 0
  /// Mass over a third of the rest area around each vertex [kg/m^2]: the fabric's, unless the scene
  /// gave the particles masses of their own.
  VertexData<double> arealDensity;
  Fabric fabric;
  std::optional<Grid> grid;  ///< how the mesh came to be, if it was a grid

  std::int32_t particleCount() const { return mesh.vertexCount(); }
};

/// One edit of a model, for everything that keeps data about it.
struct ModelChanges {
  MeshChanges mesh;
  SpringChanges springs;
};

/// Masses and areal densities of a mesh of one areal density [kg/m^2]: a third of that times the
/// rest area of every face goes to each of its corners.
void lumpMasses(double arealDensity, Model& model);
/// Masses and areal densities where every particle has the same mass [kg].
void setParticleMasses(double particleMass, Model& model);

/// Lumps the masses again around the vertices that an edit touched, at their areal densities. The
/// total is kept to round-off, whatever the densities (but for pieces that were taken away).
void followMasses(const MeshChanges& changes, Model& model);

/// Summed in ascending order of vertices, so it is the same bits for the same model.
double totalMass(const Model& model);

}  // namespace cloth_sim
