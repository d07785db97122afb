#pragma once
/// \file Rectangular grid meshes.

#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// The way in which the cells of a grid are divided into two triangles each.
enum class Diagonals {
  kOneWay,      ///< all from (i, j) to (i + 1, j + 1)
  kAlternating  ///< so where i + j is even, else from (i + 1, j) to (i, j + 1)
};

/// A rectangular grid of `columns` x `rows` vertices. Index i counts columns along u (warp), index
/// j counts rows along v (weft).
struct Grid {
  int columns = 0;
  int rows = 0;
  double width = 0.0;   ///< [m] along u
  double height = 0.0;  ///< [m] along v
  Diagonals diagonals = Diagonals::kOneWay;

  /// Returns the id of a vertex; vertices are numbered row by row.
  VertexId vertex(int i, int j) const { return j * columns + i; }
  /// Returns the material coordinates of a vertex [m].
  Vec2 material(int i, int j) const { return Vec2(i * spacingU(), j * spacingV()); }
  /// Distances between neighbours [m]. They are rounded so that their multiples are exact in double
  /// precision. Then all cells are equal to the last bit, and so are the springs in them. The sides
  /// differ from `width` and `height` by a few parts in 10^16 per cell.
  double spacingU() const;
  double spacingV() const;
};

/// Makes a triangle mesh of a grid, two faces a cell.
/// \throws std::invalid_argument unless both counts are >= 2 and both lengths are positive.
TriangleMesh makeGridMesh(const Grid& grid);

}  // namespace cloth_sim
