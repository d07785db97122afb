#pragma once
/// \file The only writer of a mesh.

#include "cloth_sim/mesh/mesh_changes.h"
#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// Edits a mesh and records what it did. Each edit keeps every face, its orientation and its rest
/// area, and leaves a valid manifold.
///
///     MeshEditor editor(mesh);
///     editor.splitVertex(v, facesOnOneSide);
///     MeshChanges changes = editor.finish();   // springs, state, clamps and solvers follow it
class MeshEditor {
 public:
  explicit MeshEditor(TriangleMesh& mesh);

  /// Opens the surface at `v`: the faces in `detach` let go of `v` and hold on to a copy of it.
  /// Where that leaves faces joined at a single point (at `v`, its copy, or a neighbour that the
  /// opening reached), the point is split too, so that the result is a manifold.
  /// \param detach  some, not all, of the faces around `v`.
  /// \return whether anything changed: false, and no edit, if `detach` is empty or all of them.
  bool splitVertex(VertexId v, const std::vector<FaceId>& detach);

  /// The changes since construction or the last call; raises the mesh's revision if there are any.
  MeshChanges finish();

 private:
  VertexId copyVertex(VertexId v);
  void rename(FaceId f, VertexId from, VertexId to);
  void separateFans(VertexId v);

  TriangleMesh& mesh_;
  MeshChanges changes_;
};

}  // namespace cloth_sim
