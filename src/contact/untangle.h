#pragma once
/// \file Opens up cloth that intersects itself.

#include <functional>
#include <vector>

#include "cloth_sim/contact/layers.h"

namespace cloth_sim {

/// Where and how far vertices may be moved.
struct UntangleOptions {
  double step = 0.0;                 ///< most motion of a vertex in a pass [m]
  std::vector<std::uint8_t> isHeld;  ///< by vertex: 1 for those that may not be moved
  int mostPasses = 400;
};

struct Untangled {
  int pairs = 0;          ///< that touched or intersected before
  int left = 0;           ///< that still do
  int passes = 0;         ///< in which vertices were moved
  double farthest = 0.0;  ///< motion of a vertex in sum [m]
};

/// Moves vertices until no two faces touch or intersect, by making the lines shorter along which
/// the surface intersects itself (intersection contour minimization, Volino & Magnenat-Thalmann
/// 2006), without regard to springs. It opens up corners, borders and bulges that stick through
/// another layer; not layers that lie in the same place, or that pass through each other from end
/// to end.
/// \param overlap  lists the pairs of faces that touch or intersect with vertices at given places.
/// \param x        positions, by vertex [m]; they are the best found if some pairs are left.
Untangled untangle(const TriangleMesh& mesh, const UntangleOptions& options,
                   const std::function<FacePairList(const std::vector<Vec3>&)>& overlap,
                   std::vector<Vec3>& x);

}  // namespace cloth_sim
