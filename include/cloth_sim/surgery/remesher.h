#pragma once
/// \file Edits of a mesh under limits on the quality of its faces.

#include <set>

#include "cloth_sim/mesh/mesh_editor.h"

namespace cloth_sim {

/// Limits on the faces that an edit may create.
struct ShapeLimits {
  double minAngle = 5.0 * 3.14159265358979323846 / 180.0;  ///< [rad]
  double minEdge = 0.0;                                    ///< [m]; 0: no limit
  double snap = 0.2;                                       ///< see SurgerySettings::snap
  /// No vertex moves, no edge flips, and edges are split on their line: cloth keeps its place in
  /// the world, also where it is bent.
  bool keepsSurface = false;
};

/// An undirected edge: its two ends in ascending order.
using EdgeKey = std::array<VertexId, 2>;
inline EdgeKey edgeKey(VertexId a, VertexId b) { return a < b ? EdgeKey{a, b} : EdgeKey{b, a}; }

/// Splits edges and faces, moves vertices and flips edges within limits: no face that an edit
/// creates has a smaller angle or a shorter edge. Edges to be cut are marked. The vertices of
/// marked edges do not move, and the parts of a split marked edge are marked too. Held vertices do
/// not move either.
///
/// Each `angleIf...` returns the smallest angle of the faces that an edit would create [rad], or a
/// negative number if the edit is not allowed. Only allowed edits may be made.
class Remesher {
 public:
  /// \param held  vertices that must not move, ascending.
  Remesher(TriangleMesh& mesh, const ShapeLimits& limits, const std::vector<VertexId>& held);

  const TriangleMesh& mesh() const { return editor_.mesh(); }
  const ShapeLimits& limits() const { return limits_; }

  /// Marks the edge {a, b}.
  void mark(VertexId a, VertexId b);
  bool isMarked(VertexId a, VertexId b) const { return marks_.count(edgeKey(a, b)) != 0; }
  const std::set<EdgeKey>& marks() const { return marks_; }
  /// Forbids to move `v` from now on.
  void hold(VertexId v) { held_.insert(v); }

  /// Returns the smallest angle [rad] after splitting the edge {a, b} with a new vertex at `at`, on
  /// the edge or beside it.
  double angleIfSplit(VertexId a, VertexId b, const Vec2& at) const;
  /// Splits the edge {a, b}. \return the new vertex.
  VertexId splitEdge(VertexId a, VertexId b, const Vec2& at);

  /// Returns the smallest angle [rad] after moving a vertex within the faces around it; on a
  /// border, along a straight part of it.
  double angleIfMoved(VertexId v, const Vec2& to) const;
  void moveVertex(VertexId v, const Vec2& to);

  /// Returns the smallest angle [rad] after splitting a face in three at a point inside it.
  double angleIfSplit(FaceId f, const Vec2& at) const;
  /// Splits a face in three. \return the new vertex.
  VertexId splitFace(FaceId f, const Vec2& at);

  /// Bisects a face at its longest edge, after the faces on its longest-edge propagation path, so
  /// that the mesh conforms after every bisection (Rivara 1984, 1997). Increments the generation of
  /// every half.
  /// \return false if the limits forbid it; faces on the path may have been bisected then.
  bool bisect(FaceId f);

  /// Flips edges of the faces that were reshaped since the last `finish`, where that increases
  /// small angles.
  void improveAngles();

  /// Opens the surface along all marked edges, and removes the marks.
  void openMarkedEdges();

  /// The vertex edits since the last `finish`.
  const std::vector<VertexEdit>& edits() const { return editor_.edits(); }
  /// Returns the changes since construction or the last call.
  MeshChanges finish() { return editor_.finish(); }

 private:
  double angleIfFlipped(VertexId a, VertexId b) const;
  bool mayMove(VertexId v, const Vec2& to) const;
  bool isTooShort(const Vec2& a, const Vec2& b) const;
  double allowed(double angle) const { return angle >= limits_.minAngle ? angle : -1.0; }
  bool improveFace(FaceId f, std::vector<FaceId>& flipped);
  EdgeKey longestEdge(FaceId f) const;

  MeshEditor editor_;
  ShapeLimits limits_;
  std::set<VertexId> held_;
  std::set<EdgeKey> marks_;
  std::set<VertexId> marked_;  ///< ends of marked edges
};

/// Returns the barycentric coordinates of `p` in a face. The third is one minus the other two, so
/// that they sum to one exactly.
std::array<double, 3> barycentric(const TriangleMesh& mesh, FaceId f, const Vec2& p);

}  // namespace cloth_sim
