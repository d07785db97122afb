#pragma once
/// \file Bending as the energy of a thin plate: an alternative to bend springs.

#include <array>
#include <limits>
#include <string>

#include "cloth_sim/mesh/material_strips.h"
#include "cloth_sim/mesh/mesh_changes.h"
#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// One quadratic term of the bending energy, 1/2 stiffness |sum_k weight[k] x[vertex[k]]|^2 [J].
/// The sum is one second derivative of the position by the material coordinates [1/m].
struct PlateElement {
  static constexpr int kMostVertices = 6;
  std::array<VertexId, kMostVertices> vertex;  ///< ascending, then kNone
  std::array<double, kMostVertices> weight;    ///< [1/m^2]; sums to zero
  double stiffness = 0.0;                      ///< rigidity times area [N m^3]; 0: no element
  int count = 0;                               ///< of vertices: 3 to 6, or 0

  template <class Archive>
  void serialize(Archive& archive) {
    archive(vertex, weight, stiffness, count);
  }
};

/// The bending energy of a plate without Poisson effect: per rest area it is
/// 1/2 B (|x_uu|^2 + 2 |x_uv|^2 + |x_vv|^2) with the rigidity B [N m]. Cloth hardly stretches, so
/// |x_uu| is the curvature of a thread, and the energy is quadratic in the positions with a
/// constant stiffness matrix (Bergou, Wardetzky, Harmon, Zorin & Grinspun 2006, A quadratic bending
/// model for inextensible surfaces).
///
/// The second derivatives are constant on each face: those of the quadratic through its corners and
/// the far corners of its three neighbours, as in rotation-free shell triangles (Onate & Zarate
/// 2000). Where a neighbour is missing, the quadratic of least energy is taken, so a free edge
/// bears no moment. On a grid the stencils are those of finite differences, three points along a
/// thread and four around a cell, whichever way the diagonals run. On any mesh they are exact for
/// quadratics wherever six points determine one; energies of single hinges are not.
class PlateBending {
 public:
  static constexpr std::size_t kPerFace = 3;  ///< elements of a face: x_uu, x_vv, x_uv
  /// The bending parameters of one cloth.
  struct Plate {
    double rigidity = 0.0;  ///< B [N m], >= 0; 0: no elements
    /// Largest stiffness that an element may put between particles [N/m], > 0. Without a limit, the
    /// slivers beside cuts would force shorter steps for bending than for stretch. With the tensile
    /// stiffness K of the membrane as the limit, faces smaller than sqrt(2 B / K) bend more easily
    /// than the fabric. That is a millimetre or less, about the thickness of the fabric.
    double maxStiffness = std::numeric_limits<double>::infinity();
    /// Moment of friction between yarns, bending less unbending, 2HB [N], >= 0 (SlipElement).
    double hysteresis = 0.0;
  };

  PlateBending() = default;
  /// Makes the elements of a single cloth; see Plate.
  PlateBending(const TriangleMesh& mesh, double rigidity,
               double maxStiffness = std::numeric_limits<double>::infinity());
  /// Makes the elements of several cloths.
  /// \param plates  one for each cloth.
  /// \throws std::invalid_argument if their number is not that of the cloths.
  PlateBending(const TriangleMesh& mesh, MaterialStrips strips, std::vector<Plate> plates);

  bool empty() const { return elements_.empty(); }
  /// The elements, three for each face; those without stiffness have no vertices.
  const std::vector<PlateElement>& elements() const { return elements_; }

  /// Tells whether some cloth has friction in bending.
  bool hasFriction() const;
  /// Stiffness of the slip element of a face [N m^3]; 0: it has none.
  double slipStiffness(FaceId f) const {
    return slip_.empty() ? 0.0 : slip_[static_cast<std::size_t>(f)];
  }
  /// Checks what was read from a file. \return one sentence about the first error; "" if none.
  std::string slipError(std::int32_t faces) const;

  /// Derives the elements again on the faces that an edit touched and on their neighbours.
  /// \param mesh  after the edit.
  void applyChanges(const TriangleMesh& mesh, const MeshChanges& changes);

  /// Multiplies the rigidity of every element and the friction, present and future.
  /// \param factor  > 0.
  void scaleBy(double factor);

  /// Returns the sum of the energies of all elements [J].
  /// \param x  positions, (vertexCount,) [m].
  double energy(const std::vector<Vec3>& x) const;

 private:
  friend class cereal::access;
  /// Archives what commands and edits change; the rest follows from the scene.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(scale_, elements_, slip_);
  }

  void resize(const TriangleMesh& mesh);
  void deriveOn(const TriangleMesh& mesh, FaceId f);
  void derive(const TriangleMesh& mesh);
  double slipStiffnessOn(FaceId f, const Plate& plate) const;

  MaterialStrips strips_;
  std::vector<Plate> plates_;  ///< by strip
  double scale_ = 1.0;         ///< factor on every stiffness
  std::vector<PlateElement> elements_;
  std::vector<double> slip_;  ///< by face: stiffness of the slip element; empty without friction
};

}  // namespace cloth_sim
