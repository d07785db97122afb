#pragma once
/// \file The cloth, or several: everything that is constant during a step.

#include "cloth_sim/cloth/plate_bending.h"
#include "cloth_sim/cloth/spring_network.h"
#include "cloth_sim/mesh/grid.h"
#include "cloth_sim/mesh/material_strips.h"
#include "cloth_sim/mesh/triangle_mesh.h"
#include "cloth_sim/mesh/vertex_data.h"

namespace cloth_sim {

/// One cloth of a model. Several do not know of each other: they are pieces of one mesh.
struct ClothPart {
  std::string name = "cloth";
  Fabric fabric;
  std::optional<Grid> grid;     ///< how its mesh came to be, if it was a grid
  VertexId firstVertex = 0;     ///< of the undamaged mesh
  std::int32_t vertices = 0;    ///< of the undamaged mesh
  double materialOffset = 0.0;  ///< where its own u = 0 lies in the material plane [m]
};

struct Model {
  TriangleMesh mesh;
  SpringNetwork springs;
  PlateBending bending;     ///< empty: bending is none, or of springs
  VertexData<double> mass;  ///< lumped [kg], > 0
  /// Mass over a third of the rest area around each vertex [kg/m^2]: the fabric's, unless the scene
  /// gave the particles masses of their own.
  VertexData<double> arealDensity;
  std::vector<ClothPart> cloths{ClothPart()};  ///< at least one
  MaterialStrips strips;                       ///< of the cloths, in their order

  std::int32_t particleCount() const { return mesh.vertexCount(); }
  /// Number of the cloth that a vertex is of.
  std::size_t clothOf(VertexId v) const { return strips.at(mesh.material(v)); }
  /// Dashpot over stiffness of every bending element [s]: cloths with bending elements have the
  /// same.
  double bendRetardation() const { return cloths.front().fabric.damping; }

  /// Brings masses, springs and bending up to date after an edit of the mesh.
  SpringChanges applyChanges(const MeshChanges& changes);

  /// Archives what edits and commands change; the rest follows from the scene.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(mesh, springs, bending, mass, arealDensity);
  }
};

/// One edit of a model, for everything that keeps data about it.
struct ModelChanges {
  MeshChanges mesh;
  SpringChanges springs;
};

/// Masses and areal densities of a cloth of one areal density [kg/m^2]: a third of that times the
/// rest area of every face goes to each of its corners.
void lumpMasses(double arealDensity, std::size_t cloth, Model& model);
/// Of a model of one cloth.
void lumpMasses(double arealDensity, Model& model);
/// Masses and areal densities of a cloth whose particles all have the same mass [kg].
void setParticleMasses(double particleMass, std::size_t cloth, Model& model);

/// Lumps the masses again around the vertices that an edit touched, at their areal densities. The
/// total of each cloth is kept to round-off, whatever the densities (but for pieces that were taken
/// away).
void applyMassChanges(const MeshChanges& changes, Model& model);

/// Summed in ascending order of vertices, so it is the same bits for the same model.
double totalMass(const Model& model);

}  // namespace cloth_sim
