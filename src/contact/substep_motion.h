#pragma once
/// \file The motion of vertices in a substep.

#include <algorithm>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// A substep, in which each vertex moves on a straight line.
struct SubstepMotion {
  const std::vector<Vec3>& start;         ///< positions, by vertex [m]
  std::vector<Vec3>& end;                 ///< the same at the end [m]
  const std::vector<double>& mass;        ///< by vertex [kg]; 0: prescribed motion
  const std::vector<VertexId>& vertices;  ///< those of all pairs at least, ascending
};

/// Mean motion of the vertices [m]: what they have in common brings nothing together.
inline Vec3 meanMotion(const SubstepMotion& motion) {
  Vec3 sum = Vec3::Zero();
  for (const VertexId v : motion.vertices) sum += motion.end[v] - motion.start[v];
  return sum / static_cast<double>(std::max<std::size_t>(1, motion.vertices.size()));
}

}  // namespace cloth_sim
