#pragma once
/// \file Bounds of tiles of a cloth, some cells each: boxes around their vertices, and balls around
/// the gradients of their faces. Kernels take four vertices or faces at a time.

#include "linalg/vector_array.h"
#include "material_level.h"
#include "support/simd.h"

namespace cloth_sim {

/// Four faces.
struct FaceLanes {
  std::int32_t corners[3][kLanes];  ///< vertices
  float inverseRest[4][kLanes];     ///< of their edges in the material plane, row by row [1/m]
};

/// The vertices and faces of a tile.
struct Tile {
  const std::int32_t* vertices;  ///< the last one may be there up to four times
  std::int32_t vertexCount;      ///< a multiple of the lanes
  const FaceLanes* faces;        ///< the last one may be there up to four times
  std::int32_t groupCount;       ///< of four faces
};

struct TileBounds {
  Box box;            ///< around the vertices [m]
  GradientBall ball;  ///< around the gradients of the faces; not finite if a position is not
};

/// Finds the bounds of a tile. \param x  positions, by vertex [m].
TileBounds boundTile(const Tile& tile, const ConstAxes& x);

}  // namespace cloth_sim
