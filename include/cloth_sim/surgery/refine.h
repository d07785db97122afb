#pragma once
/// \file Refinement of a mesh near a path.

#include <string>

#include "cloth_sim/mesh/vertex_data.h"
#include "cloth_sim/surgery/remesher.h"
#include "cloth_sim/surgery/settings.h"

namespace cloth_sim {

/// The neighbourhood of a path, in world coordinates or, with z = 0, in material coordinates.
class Neighbourhood {
 public:
  /// \param path    polyline or single point [m]; it is sampled at intervals of half of `radius`.
  /// \param radius  [m], > 0.
  Neighbourhood(const std::vector<Vec3>& path, double radius);

  /// Returns whether a point of the triangle is within `radius` of a sample.
  bool reaches(const std::array<Vec3, 3>& triangle) const;

 private:
  std::vector<Vec3> samples_;  ///< points of the path [m], ascending along axis_
  double radius_ = 0.0;        ///< [m]
  int axis_ = 0;               ///< along which the path extends farthest
};

/// Bisects the faces near a path until their generation is `refinement.generations`, or an edge
/// would be shorter than `refinement.minEdge` or than the limits of the remesher allow. The mesh
/// conforms after every bisection.
/// \param coordinates  coordinates of the vertices for `near`, (vertexCount,) [m].
/// \param seeds        faces at which the search starts; it continues across faces that `near`
///                     reaches.
/// \param maxVertices  the refinement stops when the mesh has more vertices than this.
void refineNear(const Neighbourhood& near, const Refinement& refinement,
                VertexData<Vec3> coordinates, const std::vector<FaceId>& seeds,
                std::int32_t maxVertices, Remesher& remesher);

/// Returns one sentence about what is wrong with a request; empty if nothing is.
std::string validationError(const RefineNear& request);

}  // namespace cloth_sim
