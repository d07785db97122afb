#pragma once
/// \file Bounds of tiles of a cloth, some cells each: boxes around their faces, and balls around
/// the gradients of these. Kernels take four cells at a time.

#include "linalg/vector_array.h"
#include "material_level.h"
#include "support/simd.h"

namespace cloth_sim {

/// A tile of a grid of vertices: four cells wide, however they are divided into faces.
struct GridTile {
  static constexpr std::int32_t kColumns = 4;   ///< of cells
  static constexpr std::int32_t kMostRows = 5;  ///< of vertices

  std::int32_t first = 0;   ///< vertex of the first row and column
  std::int32_t rows = 0;    ///< of vertices, 2 to kMostRows
  std::int32_t stride = 0;  ///< from a vertex to that of the next row
  Vec2 cell;                ///< sides of a cell [m]
};

struct TileBounds {
  Box box;            ///< around the faces [m]
  GradientBall ball;  ///< around the gradients of the faces; not finite if a position is not
};

/// Finds the bounds of a tile. \param x  positions, by vertex [m].
TileBounds boundTile(const GridTile& tile, const VectorArray& x);
/// Finds the bounds of the first cell of a tile alone.
TileBounds boundCell(const GridTile& tile, const VectorArray& x);

}  // namespace cloth_sim
