#pragma once
/// \file Reads the mesh of a cloth, or plain triangles, from a Wavefront OBJ file.

#include <optional>
#include <string>

#include "cloth_sim/scene/scene.h"
#include "surface_reader.h"

namespace cloth_sim {

/// The units of an OBJ file.
struct ObjUnits {
  double scale = 1.0;             ///< length unit of the positions [m], > 0
  std::optional<double> uvScale;  ///< unit of uv [m], > 0; absent: areas in space and uv agree
};

/// Reads the lines `v`, `vt` and `f` with vt, and skips all others. Divides polygons into fans of
/// triangles, reverses the faces if all are clockwise in uv, and shifts uv to a minimum of 0.
/// \throws SceneError "FILE:LINE: ..." unless the faces are an oriented manifold with boundary in
///         which every vertex has a face and exactly one uv, and every face has an area in uv, all
///         of the same sign.
ClothMesh readObj(const std::string& path, const ObjUnits& units);

/// Parses the text of a file. \param path  of the file, for messages.
ClothMesh parseObj(const std::string& text, const std::string& path, const ObjUnits& units);

/// Parses the lines `v` and `f` of a text, and skips all others; divides polygons into fans.
/// \throws SceneError "FILE:LINE: ..." as above, or for more than kMostTriangles.
Triangles parseObjTriangles(const std::string& text, const std::string& path);

}  // namespace cloth_sim
