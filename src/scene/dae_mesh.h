#pragma once
/// \file Reads plain triangles from a Collada file (.dae).

#include <string>

#include "surface_reader.h"

namespace cloth_sim {

/// Parses the geometries that the scene of a Collada 1.4 or 1.5 file instantiates, each moved by
/// the transforms of its nodes; those of its library if it has no scene. Divides polygons into fans
/// of triangles. Lengths are in metres: the unit of the file counts. Its `up_axis` does not, as in
/// rviz and MoveIt: coordinates are those of the link or obstacle. Skins are skipped.
/// \param path  of the file, for messages.
/// \throws SceneError "FILE:LINE: ..." for text that is no Collada, indices and numbers out of
///         range, or more than kMostTriangles.
Triangles parseDae(const std::string& bytes, const std::string& path);

}  // namespace cloth_sim
