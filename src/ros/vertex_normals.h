#pragma once
/// \file Normals of a triangle mesh. No ROS in here.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "cloth_sim/mesh/triangle_mesh.h"

namespace cloth_sim {

/// Returns the normal of a face, to the front of the cloth; its length is twice the area [m^2].
inline Eigen::Vector3f areaNormal(const Face& face, const std::vector<Vec3>& positions) {
  const Vec3& a = positions[face[0]];
  const Vec3 ab = positions[face[1]] - a;
  const Vec3 ac = positions[face[2]] - a;
  return ab.cast<float>().cross(ac.cast<float>());
}

/// Returns `normal` at unit length; z if it is zero.
inline Eigen::Vector3f unitNormal(const Eigen::Vector3f& normal) {
  // In double: the square of a flat cloth's rounding errors is a subnormal float, which is slow.
  const double length = normal.cast<double>().norm();
  return length > 0.0 ? Eigen::Vector3f(normal * static_cast<float>(1.0 / length))
                      : Eigen::Vector3f::UnitZ();
}

/// Computes the mean normal of the faces around each vertex, weighted by area.
/// \param positions  of each vertex [m].
/// \param normals    the result, unit vectors; resized to the number of positions.
void vertexNormals(const std::vector<Face>& faces, const std::vector<Vec3>& positions,
                   std::vector<Eigen::Vector3f>& normals);

}  // namespace cloth_sim
