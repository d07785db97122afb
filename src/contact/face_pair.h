#pragma once
/// \file Two faces near each other, and the direction that proves that they stay apart.

#include <algorithm>
#include <vector>

#include "closest_points.h"
#include "cloth_sim/mesh/triangle_mesh.h"
#include "substep_motion.h"

namespace cloth_sim {

/// Two faces, and a direction in which one is beyond the other.
struct FacePair {
  FacePair(const Face& first, const Face& second);

  Face a;  ///< the corners; those that both faces share come last, in the same order
  Face b;
  std::int32_t shared = 0;        ///< number of shared corners: 0, 1 or 2
  bool isFixed = false;           ///< motion of its vertices was shortened in this substep
  Vec3 direction = Vec3::Zero();  ///< n, from b to a; 0: not known yet
};

/// Distance up to which two faces do not count as apart [m]: far above round-off, far below the
/// thickness of cloth.
constexpr double kApart = 1e-8;

/// The least place of a corner along a direction [m].
inline double leastOf(const Face& face, const Vec3& n, const std::vector<Vec3>& x) {
  return std::min({n.dot(x[face[0]]), n.dot(x[face[1]]), n.dot(x[face[2]])});
}
/// The greatest one [m].
inline double mostOf(const Face& face, const Vec3& n, const std::vector<Vec3>& x) {
  return std::max({n.dot(x[face[0]]), n.dot(x[face[1]]), n.dot(x[face[2]])});
}

/// Tells whether a direction separates two faces, except for corners that they share.
bool areApart(const Face& a, const Face& b, const std::vector<Vec3>& x);
/// Finds the direction along which the faces are farthest apart; but for corners that they share.
SeparatingDirection bestDirection(const FacePair& pair, const std::vector<Vec3>& x);
/// Finds a direction for the end of the substep, near `before`, if the pair overlaps there: the one
/// with the least overlap of some.
Vec3 endDirection(FacePair pair, const Vec3& before, const std::vector<Vec3>& end);
/// Finds how far the faces of a pair may travel until they may touch, if they stay apart in the
/// substep; finds other directions where that helps. \return 0 if they may not [m].
double slackOf(FacePair& pair, const SubstepMotion& motion);

}  // namespace cloth_sim
