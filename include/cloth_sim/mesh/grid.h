#pragma once
/// \file Rectangular grid meshes.

#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// A grid of `columns` x `rows` vertices, `width` x `height` metres in material coordinates.
/// Column i runs along u (warp), row j along v (weft).
struct Grid {
  int columns = 0;
  int rows = 0;
  double width = 0.0;   ///< [m] along u
  double height = 0.0;  ///< [m] along v

  /// Vertices are numbered row by row.
  VertexId vertex(int i, int j) const { return j * columns + i; }
  /// Material coordinates of a vertex [m].
  Vec2 material(int i, int j) const { return Vec2(i * spacingU(), j * spacingV()); }
  /// Between neighbours [m]: what divides the sides evenly, but for a few parts in 10^16 of them,
  /// so that its multiples are exact. Then all cells are the same, to the last bit, and so are the
  /// springs in them. The sides are longer or shorter by as many parts in 10^16 a cell.
  double spacingU() const;
  double spacingV() const;
};

/// Every cell is cut into two triangles along its rising diagonal, (i, j) to (i+1, j+1).
/// \throws std::invalid_argument unless both counts are >= 2 and both lengths are positive.
TriangleMesh makeGridMesh(const Grid& grid);

}  // namespace cloth_sim
