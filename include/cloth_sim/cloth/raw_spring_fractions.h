#pragma once
/// \file Division of the constants of raw springs among the parts of edited springs.

#include "cloth_sim/mesh/mesh_changes.h"
#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// The fraction of a raw constant that a spring has, and the length to which the constant refers.
struct RawSpringFraction {
  double fraction = 0.0;    ///< 1 in the undamaged mesh
  double restLength = 0.0;  ///< of the whole spring in the undamaged mesh [m]; 0: not known
};

/// Divides raw spring constants among faces, so that edits of the mesh conserve them.
///
/// Each face holds a fraction of the constants of its three edges, and of the bend springs at its
/// three corners, in proportion to its rest area. Where the surface opens, each side keeps the
/// fractions of its faces. A part of a split edge inherits the fraction and the rest length of the
/// whole: half of a spring is twice as stiff.
class RawSpringFractions {
 public:
  RawSpringFractions() = default;
  explicit RawSpringFractions(const TriangleMesh& mesh);

  /// Number of faces that hold fractions.
  std::size_t size() const { return fractions_.size(); }

  /// Divides the constants anew on the faces that an edit reshaped.
  void applyChanges(const TriangleMesh& mesh, const MeshChanges& changes);

  /// Returns the fraction of the spring on the edge {a, b}.
  /// \param on  the faces on the edge.
  RawSpringFraction ofEdge(const TriangleMesh& mesh, const IndexSpan& on, VertexId a,
                           VertexId b) const;
  /// Returns the fraction of a bend spring over `v`. Its rest length is 1 m where all faces are
  /// those of the original mesh, and 0 elsewhere.
  /// \param around  the faces around `v`.
  RawSpringFraction ofCorners(const TriangleMesh& mesh, const IndexSpan& around, VertexId v) const;

 private:
  /// The fractions that one face holds. Edge k runs from corner k to the next corner.
  struct FaceFractions {
    Face face{kNone, kNone, kNone};  ///< its corners when this was last updated
    std::array<double, 3> edge{0.0, 0.0, 0.0};
    std::array<double, 3> restLength{0.0, 0.0, 0.0};  ///< of the original edges [m]
    std::array<double, 3> corner{0.0, 0.0, 0.0};
    bool reshaped = false;  ///< the face is not one of the original mesh any more

    template <class Archive>
    void serialize(Archive& archive) {
      archive(face, edge, restLength, corner, reshaped);
    }
  };
  struct Inheritance;

  static FaceFractions fractionsOf(const TriangleMesh& mesh, FaceId f);
  Inheritance inheritanceOf(const MeshChanges& changes) const;
  void applyRemoval(const TriangleMesh& mesh, const MeshChanges& changes);

  friend class cereal::access;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(fractions_);
  }

  std::vector<FaceFractions> fractions_;  ///< by face
};

}  // namespace cloth_sim
