#pragma once
/// \file The model: everything about one or several cloths that is constant during a step.

#include "cloth_sim/cloth/plate_bending.h"
#include "cloth_sim/cloth/spring_network.h"
#include "cloth_sim/mesh/grid.h"
#include "cloth_sim/mesh/material_strips.h"
#include "cloth_sim/mesh/triangle_mesh.h"
#include "cloth_sim/mesh/vertex_data.h"

namespace cloth_sim {

/// One cloth of a model. Several cloths are connected components of one mesh.
struct ClothPart {
  std::string name = "cloth";
  Fabric fabric;
  std::optional<Grid> grid;     ///< the grid that its mesh was made from, if any
  VertexId firstVertex = 0;     ///< of its vertices in the undamaged mesh
  std::int32_t vertices = 0;    ///< number of its vertices in the undamaged mesh
  double materialOffset = 0.0;  ///< u of its own origin in the material plane [m]
};

/// Mesh, springs, bending elements and masses of one or several cloths.
struct Model {
  TriangleMesh mesh;
  SpringNetwork springs;
  PlateBending bending;     ///< empty if bend springs resist bending, or nothing does
  VertexData<double> mass;  ///< lumped [kg], > 0
  /// Mass per third of the rest area around each vertex [kg/m^2]. It is that of the fabric unless
  /// the scene specifies the mass of a particle.
  VertexData<double> arealDensity;
  std::vector<ClothPart> cloths{ClothPart()};  ///< at least one
  MaterialStrips strips;                       ///< of the cloths, in their order

  std::int32_t particleCount() const { return mesh.vertexCount(); }
  /// Returns the index into `cloths` of the cloth that a vertex belongs to.
  std::size_t clothOf(VertexId v) const { return strips.at(mesh.material(v)); }
  /// Retardation time of every bending element, dashpot over stiffness [s]. All cloths with bending
  /// elements have the same.
  double bendRetardation() const { return cloths.front().fabric.bendRetardation(); }

  /// Brings masses, springs and bending up to date after an edit of the mesh.
  SpringChanges applyChanges(const MeshChanges& changes);

  /// Archives what edits and commands change; the rest follows from the scene.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(mesh, springs, bending, mass, arealDensity);
  }
};

/// The changes that one edit made to a model, for everything that keeps data about it.
struct ModelChanges {
  MeshChanges mesh;
  SpringChanges springs;
};

/// Sets masses and areal densities of a cloth: each face gives a third of its mass to each corner.
/// \param arealDensity  [kg/m^2]
void lumpMasses(double arealDensity, std::size_t cloth, Model& model);
/// Sets masses and areal densities of the only cloth of a model.
void lumpMasses(double arealDensity, Model& model);
/// Sets masses and areal densities of a cloth whose particles all have the same mass [kg].
void setParticleMasses(double particleMass, std::size_t cloth, Model& model);

/// Lumps the masses of the vertices that an edit touched again, at their areal densities. The total
/// mass of each cloth stays the same up to rounding, except for removed components.
void applyMassChanges(const MeshChanges& changes, Model& model);

/// Returns the sum of all masses [kg], added in ascending order of vertices, so that equal models
/// give equal bits.
double totalMass(const Model& model);

}  // namespace cloth_sim
