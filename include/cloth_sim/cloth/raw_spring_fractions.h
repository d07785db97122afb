#pragma once
/// \file How the constants of raw springs follow edits of their mesh.

#include "cloth_sim/mesh/mesh_changes.h"
#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// What part of a raw constant a spring has, and the rest length that the constant holds for.
struct RawSpringFraction {
  double part = 0.0;    ///< one in the undamaged mesh
  double length = 0.0;  ///< [m]; 0: not known
};

/// Each face's part of the constants of its edges, and of the bend springs at its corners. A part
/// of an edge takes over the share of the whole and the length that it held for (half of a spring
/// is twice as stiff); where the surface opens, both sides keep what was theirs.
class RawSpringFractions {
 public:
  RawSpringFractions() = default;
  explicit RawSpringFractions(const TriangleMesh& mesh);

  void applyChanges(const TriangleMesh& mesh, const MeshChanges& changes);

  /// Of the edge {a, b}, by the faces on it.
  RawSpringFraction ofEdge(const TriangleMesh& mesh, const IndexSpan& on, VertexId a,
                           VertexId b) const;
  /// Of a bend spring over `v`, by the faces around it. The length is 0 where the mesh is not the
  /// original one, and 1 m where it is.
  RawSpringFraction ofCorners(const TriangleMesh& mesh, const IndexSpan& around, VertexId v) const;

 private:
  struct Shares {
    Face face{kNone, kNone, kNone};  ///< its corners when this was up to date
    std::array<double, 3> edge{0.0, 0.0, 0.0};
    std::array<double, 3> length{0.0, 0.0, 0.0};  ///< of the edge that each was part of at first
    std::array<double, 3> corner{0.0, 0.0, 0.0};
    bool remade = false;  ///< the face is not one of the original mesh any more

    template <class Archive>
    void serialize(Archive& archive) {
      archive(face, edge, length, corner, remade);
    }
  };

  static Shares fresh(const TriangleMesh& mesh, FaceId f);
  void applyRemoval(const TriangleMesh& mesh, const MeshChanges& changes);

  friend class cereal::access;
  template <class Archive>
  void serialize(Archive& archive) {
    archive(shares_);
  }

  std::vector<Shares> shares_;  ///< by face
};

}  // namespace cloth_sim
