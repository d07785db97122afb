#pragma once
/// \file Edits that change the shape of faces, under limits that keep slivers out.

#include <set>

#include "cloth_sim/mesh/mesh_editor.h"

namespace cloth_sim {

/// What faces an edit may make.
struct ShapeLimits {
  double minAngle = 5.0 * 3.14159265358979323846 / 180.0;  ///< [rad]
  double minEdge = 0.0;                                    ///< [m]; 0: any
  double snap = 0.2;                                       ///< see SurgerySettings::snap
};

/// Two vertices, the smaller one first.
using EdgeKey = std::array<VertexId, 2>;
inline EdgeKey edgeKey(VertexId a, VertexId b) { return a < b ? EdgeKey{a, b} : EdgeKey{b, a}; }

/// Splits, moves and flips within the limits: every face that it makes has no smaller angle and no
/// shorter edge than they allow. Edges may be marked (they are to be cut): their vertices stay
/// where they are, and their parts are marked too. Held vertices do not move either.
///
/// Each `angleIf...` gives the smallest angle of the faces that an edit would make [rad], or a
/// negative number if the edit is not allowed; only edits that are may be asked for.
class Remesher {
 public:
  /// \param held  ascending.
  Remesher(TriangleMesh& mesh, const ShapeLimits& limits, const std::vector<VertexId>& held);

  const TriangleMesh& mesh() const { return editor_.mesh(); }
  const ShapeLimits& limits() const { return limits_; }

  void mark(VertexId a, VertexId b);
  bool isMarked(VertexId a, VertexId b) const { return marks_.count(edgeKey(a, b)) != 0; }
  const std::set<EdgeKey>& marks() const { return marks_; }
  /// From here on `v` does not move.
  void hold(VertexId v) { held_.insert(v); }

  /// Splitting the edge {a, b} with the new vertex at `at`, on it or beside it.
  double angleIfSplit(VertexId a, VertexId b, const Vec2& at) const;
  VertexId splitEdge(VertexId a, VertexId b, const Vec2& at);

  /// Moving a vertex within the faces around it; at a border, along it.
  double angleIfMoved(VertexId v, const Vec2& to) const;
  void moveVertex(VertexId v, const Vec2& to);

  /// Putting a vertex into a face.
  double angleIfSplit(FaceId f, const Vec2& at) const;
  VertexId splitFace(FaceId f, const Vec2& at);

  /// Halves a face and its neighbour at their longest edge, after halving as many others as must
  /// come before it, so that the mesh conforms at all times (Rivara 1984, 1997). Raises the
  /// generation of every half.
  /// \return whether it did; false if the limits forbid it.
  bool bisect(FaceId f);

  /// Flips edges near what was edited since the last `finish` where that makes bad angles better.
  void improve();

  /// Opens the surface along all marked edges, and forgets the marks. Nothing else may be edited
  /// between `finish` and this, so that what the opening broke can be told apart.
  void openMarks();

  /// The edits of the list of vertices since the last `finish`.
  const std::vector<VertexEdit>& edits() const { return editor_.edits(); }
  MeshChanges finish() { return editor_.finish(); }

 private:
  double angleIfFlipped(VertexId a, VertexId b) const;
  bool mayMove(VertexId v, const Vec2& to) const;
  bool isTooShort(const Vec2& a, const Vec2& b) const;
  double allowed(double angle) const { return angle >= limits_.minAngle ? angle : -1.0; }
  bool improveFace(FaceId f, std::vector<FaceId>& next);
  EdgeKey longestEdge(FaceId f) const;

  MeshEditor editor_;
  ShapeLimits limits_;
  std::set<VertexId> held_;
  std::set<EdgeKey> marks_;
  std::set<VertexId> marked_;  ///< ends of marks
};

/// Barycentric weights of `p` in a face, the first two computed and the third the rest to one.
std::array<double, 3> barycentric(const TriangleMesh& mesh, FaceId f, const Vec2& p);

}  // namespace cloth_sim
