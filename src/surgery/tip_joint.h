#pragma once
/// \file Paths of cuts that continue from the tips of earlier cuts and tears.

#include <vector>

#include "cloth_sim/surgery/stroke.h"

namespace cloth_sim {

/// The tips that paths join. Distances are from the end of a path, in the material [m].
struct JoinedTips {
  double reach = 0.0;       ///< within which both ends join any tip
  std::vector<Vec2> known;  ///< ends that the paths continue from, material coordinates [m]
  double knownReach = 0.0;  ///< within which the first point joins one of those before any other
};

/// Lets the open paths that begin or end inside the cloth near a tip (`isTip`) begin or end exactly
/// there, so that a line drawn in several strokes is one cut although the cloth moves between them.
///
/// An end that is d off the tip gives way to it, with the points that follow within d of the tip.
/// If no point is farther away, the last one stays if it is ahead of the tip; if not, the earlier
/// cut has been there, and the path is dropped. Both ends of a path may join a tip, but not tips
/// within `reach` of each other: what begins at a tip does not end at it. A known end within
/// `reach` is joined even if it is no tip, where a cut bent to the border. Other paths stay as they
/// are.
void joinTips(const TriangleMesh& mesh, const JoinedTips& tips, std::vector<SurfacePath>& paths);

}  // namespace cloth_sim
