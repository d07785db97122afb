#pragma once
/// \file The only writer of a mesh.

#include "cloth_sim/mesh/mesh_changes.h"
#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// Edits a mesh and records what it did. Each edit leaves a valid manifold, and (but for
/// `removeComponents`) keeps the rest area and the orientation of the faces.
///
///     MeshEditor editor(mesh);
///     editor.splitVertex(v, facesOnOneSide);
///     MeshChanges changes = editor.finish();   // springs, state, clamps and solvers follow it
///
/// The editor does not judge shapes: see surgery/remesher.h for what may be done without slivers.
class MeshEditor {
 public:
  explicit MeshEditor(TriangleMesh& mesh);

  const TriangleMesh& mesh() const { return mesh_; }

  /// Opens the surface at `v`: the faces in `detach` let go of `v` and hold on to a copy of it.
  /// Where that leaves faces joined at a single point (at `v`, its copy, or a neighbour that the
  /// opening reached), the point is split too, so that the result is a manifold.
  /// \param detach  some, not all, of the faces around `v`.
  /// \return whether anything changed: false, and no edit, if `detach` is empty or all of them.
  bool splitVertex(VertexId v, const std::vector<FaceId>& detach);

  /// Puts a vertex on the edge {a, b}, at a + t (b - a), 0 < t < 1, and splits the faces on it.
  VertexId splitEdge(VertexId a, VertexId b, double t);
  /// Puts a vertex into a face, at positive barycentric weights, and splits the face in three.
  VertexId splitFace(FaceId f, const std::array<double, 3>& weight);
  /// Replaces the edge between two faces by the other diagonal of their (convex) quadrilateral.
  void flipEdge(VertexId a, VertexId b);
  /// Moves `v` within the surface, to the point of `f` at `weight`. A vertex on the border may only
  /// move along a straight border, or the rest area is not kept.
  void moveVertex(VertexId v, FaceId f, const std::array<double, 3>& weight);
  /// Raises the generation of a face: how many bisections it is from the original mesh.
  void raiseGeneration(FaceId f);

  /// Takes whole pieces away. Vertices and faces change their numbers: no other edit may share the
  /// changes with this one.
  /// \param faces  every face of the pieces, ascending.
  void removeComponents(const std::vector<FaceId>& faces);

  /// The edits of the list of vertices so far.
  const std::vector<VertexEdit>& edits() const { return changes_.vertices; }

  /// Faces that have been made or have changed their shape so far, in no order.
  const std::vector<FaceId>& reshaped() const { return changes_.reshapedFaces; }

  /// The changes since construction or the last call; raises the mesh's revision if there are any.
  MeshChanges finish();

 private:
  VertexId addVertex(const VertexEdit& edit);
  VertexId copyVertex(VertexId v);
  void rename(FaceId f, VertexId from, VertexId to);
  void separateFans(VertexId v);
  FaceId addFace(const Face& face, std::uint8_t rim, FaceId parent);
  void setFace(FaceId f, const Face& face, std::uint8_t rim);
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
  // Whether a vertex or face is in the lists of changes_ already.
  std::vector<bool> isTouched_;
  std::vector<bool> isChanged_;
  std::vector<bool> isReshaped_;
};

}  // namespace cloth_sim
