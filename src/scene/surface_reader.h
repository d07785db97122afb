#pragma once
/// \file Reads the triangles of an obstacle from a file: STL, Wavefront OBJ or Collada.

#include <string>
#include <vector>

#include "cloth_sim/contact/shapes/mesh.h"

namespace cloth_sim {

/// Triangles by the indices of their corners.
struct Triangles {
  std::vector<Vec3> vertices;  ///< [length unit of the file]
  std::vector<TriangleSurface::Triangle> corners;
};

/// Reads a file by the end of its name: `.stl`, in text or binary, `.obj` or `.dae`.
/// \param name   of the file in the scene.
/// \param scale  length unit of the file along each axis [m]; for `.dae`, which tells its unit, a
///               factor [-]. Negative: mirrored.
/// \throws SceneError with the name of the file in one line.
SurfaceFile readSurface(const std::string& path, const std::string& name, const Vec3& scale);

/// Makes one vertex of all corners at the same place. \param corners  three for each triangle.
Triangles weld(std::vector<Vec3> corners);

/// Parses the contents of an STL file. Corners at the same place become one vertex.
/// \param path  of the file, for messages. \throws SceneError
Triangles parseStl(const std::string& bytes, const std::string& path);

}  // namespace cloth_sim
