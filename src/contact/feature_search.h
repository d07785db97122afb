#pragma once
/// \file The search for the faces and edges of the cloth that sharp features of a mesh may meet.

#include <vector>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/contact/contacts.h"
#include "cloth_sim/mesh/triangle_mesh.h"
#include "feature_meeting.h"

namespace cloth_sim {

/// The motion of a collider within a step, for the search of what it may meet.
struct FeatureSearch {
  Vec3 velocity = Vec3::Zero();  ///< of its origin [m/s]
  double dt = 0.0;               ///< length of the step [s]
  double turn = 0.0;             ///< angle by which it turns in the step [rad]
  double reach = 0.0;  ///< distance that cloth may move beyond its relative speed times dt [m]
};

/// Appends the pairs of a sharp corner and a face of the cloth, and of a sharp edge and an edge of
/// the cloth, that may meet within a step; by faces, ascending.
void collectPairs(const PlacedFeatures& placed, const TriangleMesh& mesh, const State& state,
                  const FeatureSearch& search, std::vector<std::int32_t>& scratch,
                  std::vector<FeaturePair>& out);

}  // namespace cloth_sim
