#pragma once
/// \file Elementary edits of a mesh.

#include "cloth_sim/mesh/mesh_changes.h"
#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// Edits a mesh and records the changes. No other class modifies a mesh after construction. Each
/// edit leaves a valid manifold and, except for `removeComponents`, keeps the rest area and the
/// orientation of the faces.
///
///     MeshEditor editor(mesh);
///     editor.splitVertex(v, facesOnOneSide);
///     MeshChanges changes = editor.finish();   // applied by state, springs, clamps, solvers
///
/// The editor does not prevent slivers; `Remesher` does.
class MeshEditor {
 public:
  explicit MeshEditor(TriangleMesh& mesh);

  const TriangleMesh& mesh() const { return mesh_; }

  /// Opens the surface at `v`: the faces in `detach` get a copy of `v` as their corner. Where that
  /// leaves faces joined at a single point (at `v`, at its copy, or at a neighbour), that point is
  /// copied too, so that the result is a manifold.
  /// \param detach  some of the faces around `v`.
  /// \return false, without an edit, if `detach` is empty or has all faces around `v`.
  bool splitVertex(VertexId v, const std::vector<FaceId>& detach);

  /// Splits the edge {a, b} at a + t (b - a), 0 < t < 1, and halves the faces on it.
  /// \return the new vertex.
  VertexId splitEdge(VertexId a, VertexId b, double t);
  /// Splits a face in three at a point inside it.
  /// \param weight  barycentric coordinates of the point, all positive.
  /// \return the new vertex.
  VertexId splitFace(FaceId f, const std::array<double, 3>& weight);
  /// Replaces the inner edge {a, b} by the other diagonal of its two faces, which must form a
  /// convex quadrilateral.
  void flipEdge(VertexId a, VertexId b);
  /// Moves `v` within the surface, to a point of a face around it. A vertex on the border must move
  /// along a straight part of the border, or the rest area changes.
  /// \param weight  barycentric coordinates of the point in `f`.
  void moveVertex(VertexId v, FaceId f, const std::array<double, 3>& weight);
  /// Increments the generation of a face, see `TriangleMesh::generation`.
  void raiseGeneration(FaceId f);

  /// Removes connected components. Vertices and faces are renumbered, so the same `MeshChanges`
  /// must not contain any other edit.
  /// \param faces  all faces of the components, ascending.
  void removeComponents(const std::vector<FaceId>& faces);

  /// The vertex edits since construction or the last `finish`.
  const std::vector<VertexEdit>& edits() const { return changes_.vertices; }

  /// New and reshaped faces since construction or the last `finish`, unordered.
  const std::vector<FaceId>& reshaped() const { return changes_.reshapedFaces; }

  /// Returns the changes since construction or the last call, and increments the revision of the
  /// mesh if there are any.
  MeshChanges finish();

 private:
  VertexId addVertex(const VertexEdit& edit);
  VertexId copyVertex(VertexId v);
  void replaceCorner(FaceId f, VertexId from, VertexId to);
  void separateFans(VertexId v);
  FaceId addFace(const Face& face, std::uint8_t boundaryBits, FaceId parent);
  void setFace(FaceId f, const Face& face, std::uint8_t boundaryBits);
  void link(FaceId f, VertexId v);
  void unlink(FaceId f, VertexId v);
  void recordReshaped(FaceId f);
  void halveFace(FaceId f, VertexId a, VertexId b, VertexId middle);
  void removeFace(FaceId f);
  void removeVertex(VertexId v);
  Vec2 blendMaterial(const VertexEdit& edit) const;

  void touch(const Face& face);
  void touch(VertexId v);
  void recordChanged(FaceId f);

  TriangleMesh& mesh_;
  MeshChanges changes_;
  // Flags of the vertices and faces that the lists of changes_ have already.
  std::vector<bool> isTouched_;
  std::vector<bool> isChanged_;
  std::vector<bool> isReshaped_;
};

}  // namespace cloth_sim
