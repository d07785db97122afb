#pragma once
/// \file Making a mesh finer near some points.

#include <string>

#include "cloth_sim/mesh/vertex_data.h"
#include "cloth_sim/surgery/remesher.h"
#include "cloth_sim/surgery/settings.h"

namespace cloth_sim {

/// Some points, and what is near to them: in the world, or (with z = 0) in material coordinates.
class Neighbourhood {
 public:
  /// \param path    polyline or single point [m]; it is sampled at half of `radius`.
  /// \param radius  [m], > 0.
  Neighbourhood(const std::vector<Vec3>& path, double radius);

  /// Whether some point of the triangle is within `radius` of a sample.
  bool reaches(const std::array<Vec3, 3>& triangle) const;

 private:
  std::vector<Vec3> samples_;  ///< ascending along axis_
  double radius_ = 0.0;
  int axis_ = 0;
};

/// Bisects faces near a path until they have `refinement.generations`, or an edge would be shorter
/// than `refinement.minEdge` (or than the limits allow). Conforming after every bisection.
/// \param coordinates  where `near` looks for the vertices: a copy, which follows the edits.
/// \param seeds        faces to begin at; the search goes on over faces that `near` reaches.
/// \param maxVertices  gives up when the mesh has more.
void refineNear(const Neighbourhood& near, const Refinement& refinement,
                VertexData<Vec3> coordinates, const std::vector<FaceId>& seeds,
                std::int32_t maxVertices, Remesher& remesher);

/// Why a request cannot be carried out; empty if it can.
std::string validationError(const RefineNear& request);

/// The point of a triangle that is nearest to `p`.
Vec3 nearestPoint(const std::array<Vec3, 3>& triangle, const Vec3& p);

}  // namespace cloth_sim
