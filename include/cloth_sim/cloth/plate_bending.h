#pragma once
/// \file Bending as an energy of curvature, in SI bending rigidity: an alternative to bend springs.

#include <array>
#include <limits>

#include "cloth_sim/mesh/material_strips.h"
#include "cloth_sim/mesh/mesh_changes.h"
#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// A quadratic energy 1/2 stiffness |sum over k of weight[k] x[vertex[k]]|^2 [J]. The sum is one
/// component of the second derivative of the position by the material coordinates [1/m].
struct PlateElement {
  static constexpr int kMostVertices = 6;
  std::array<VertexId, kMostVertices> vertex;  ///< ascending, then kNone
  std::array<double, kMostVertices> weight;    ///< [1/m^2]; they sum to zero
  double stiffness = 0.0;                      ///< rigidity times area [N m^3]; 0: no element
  int count = 0;                               ///< of vertices: 3 to 6, or 0

  template <class Archive>
  void serialize(Archive& archive) {
    archive(vertex, weight, stiffness, count);
  }
};

/// The bending energy of a plate without Poisson effect, 1/2 B (|x_uu|^2 + 2 |x_uv|^2 + |x_vv|^2)
/// per area, B the rigidity [N m]. As cloth hardly stretches, |x_uu| is the curvature of a thread;
/// the energy is then quadratic in the positions, with constant stiffness (Bergou, Wardetzky,
/// Harmon, Zorin & Grinspun 2006, A quadratic bending model for inextensible surfaces).
///
/// The second derivatives are constant on each face: those of the quadratic through its corners and
/// the far corners of its three neighbours, as in rotation-free shell triangles (Onate & Zarate
/// 2000). Where a neighbour is missing, the quadratic of least energy: a free edge bears no moment.
/// On a grid the stencils are those of finite differences, three points along a thread and four
/// around a cell, whichever way the diagonals run; on any mesh they are exact for quadratics
/// wherever six points determine one, which energies of single hinges are not.
class PlateBending {
 public:
  /// What the elements of one cloth are made from.
  struct Plate {
    double rigidity = 0.0;  ///< [N m], >= 0; 0: there are none
    /// Stiffness that an element may put between particles [N/m], > 0. With the membrane's tensile
    /// stiffness K, faces below sqrt(2 rigidity / K) in size (a millimetre or less: about the
    /// thickness of the fabric) bend more easily, so that slivers beside cuts do not need shorter
    /// steps for their bending than for their threads.
    double most = std::numeric_limits<double>::infinity();
  };

  PlateBending() = default;
  /// Of one cloth; see Plate.
  PlateBending(const TriangleMesh& mesh, double rigidity,
               double most = std::numeric_limits<double>::infinity());
  /// \param plates  one for each strip.
  PlateBending(const TriangleMesh& mesh, MaterialStrips strips, std::vector<Plate> plates);

  bool empty() const { return elements_.empty(); }
  /// Three per face, of which some may be without stiffness.
  const std::vector<PlateElement>& elements() const { return elements_; }

  /// Derives the elements anew on the faces that an edit touched and beside them.
  void applyChanges(const TriangleMesh& mesh, const MeshChanges& changes);

  /// Multiplies the rigidity of every element, there now or made later.
  /// \param factor  > 0.
  void scaleBy(double factor);

  /// Sum of the energies of all elements [J].
  double energy(const std::vector<Vec3>& x) const;

 private:
  friend class cereal::access;
  /// What commands and edits change; the rest is as the scene has it.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(scale_, elements_);
  }

  static constexpr std::size_t kPerFace = 3;
  void deriveOn(const TriangleMesh& mesh, FaceId f);
  void derive(const TriangleMesh& mesh);

  MaterialStrips strips_;
  std::vector<Plate> plates_;  ///< by strip
  double scale_ = 1.0;         ///< of every stiffness
  std::vector<PlateElement> elements_;
};

}  // namespace cloth_sim
