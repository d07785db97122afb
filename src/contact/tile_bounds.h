#pragma once
/// \file Bounds of tiles of a cloth, some cells each: boxes around their faces, and balls around
/// the gradients of these. Kernels take four faces at a time.

#include "linalg/vector_array.h"
#include "material_level.h"
#include "support/simd.h"

namespace cloth_sim {

/// Four faces.
struct FaceLanes {
  std::int32_t corners[3][kLanes];  ///< vertices
  float inverseRest[4][kLanes];     ///< of their edges in the material plane, row by row [1/m]
};

/// Four faces of one shape side by side: the corners of each are the vertices after those of the
/// one before. Kernels load them without gathers.
struct FaceRun {
  std::int32_t corners[3];  ///< vertices of the first face
  float inverseRest[4];     ///< of the edges of each in the material plane, row by row [1/m]
};

/// The faces of a tile.
struct Tile {
  const FaceRun* runs;
  std::int32_t runCount;
  const FaceLanes* faces;   ///< those in no run; the last one may be there up to four times
  std::int32_t groupCount;  ///< of four faces
};

struct TileBounds {
  Box box;            ///< around the faces [m]
  GradientBall ball;  ///< around the gradients of the faces; not finite if a position is not
};

/// Finds the bounds of a tile. \param x  positions, by vertex [m].
TileBounds boundTile(const Tile& tile, const ConstAxes& x);

}  // namespace cloth_sim
