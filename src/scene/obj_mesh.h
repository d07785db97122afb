#pragma once
/// \file Cloth from a Wavefront OBJ file.

#include <optional>
#include <string>

#include "cloth_sim/scene/scene.h"

namespace cloth_sim {

/// How the numbers of an OBJ file become metres.
struct ObjUnits {
  double scale = 1.0;             ///< of the positions [m per unit], > 0
  std::optional<double> uvScale;  ///< [m per unit]; absent: so that the areas in space and uv agree
};

/// Reads `v`, `vt` and `f` with vt; all else is skipped. Polygons become fans of triangles. Where
/// all faces are clockwise in uv, they are turned round; uv are moved so that the least are 0.
/// \throws SceneError "FILE:LINE: ..." unless the faces are an oriented manifold with boundary,
/// with
///         one uv for each vertex that gives every face an area of the same sign, and every vertex
///         has a face.
ClothMesh readObj(const std::string& path, const ObjUnits& units);

/// The same from text; `path` is for messages.
ClothMesh parseObj(const std::string& text, const std::string& path, const ObjUnits& units);

}  // namespace cloth_sim
