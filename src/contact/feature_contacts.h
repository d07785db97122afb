#pragma once
/// \file Contact of the sharp corners and edges of a mesh with the faces and edges of the cloth.

#include <vector>

#include "cloth_sim/cloth/state.h"
#include "cloth_sim/contact/contacts.h"
#include "cloth_sim/mesh/triangle_mesh.h"
#include "collider_substep.h"
#include "sharp_features.h"

namespace cloth_sim {

/// A mesh with its sharp corners and edges, in space.
struct PlacedFeatures {
  const TriangleSurface& surface;
  const SharpFeatures& features;
  Vec3 position;             ///< of its origin [m]
  Eigen::Matrix3d rotation;  ///< from its axes to those of the world
};

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

/// Moves faces and edges of the cloth away from corners and edges of the mesh, with friction, as
/// displacements of their particles in proportion to their weights and inverse masses. Corners and
/// edges stay on the side of the cloth where they are at the start of the substep; paths are swept
/// as straight lines in the frame of the collider. Faces of the cloth that a corner of a closed
/// mesh has pierced at the start of the step leave it at up to `kDepenetrationSpeed`. \param placed
/// at the end of the substep. \param margin  distance that cloth keeps [m]. \return the moments of
/// all displacements.
Moments projectPairs(const PlacedFeatures& placed, const ColliderSubstep& substep, double margin,
                     const ParticleView& particles, std::vector<FeaturePair>& pairs);

/// Lets the particles of pairs that would still pass through each other move along with the
/// collider: then none does, unless held particles force it. Does nothing while any pair
/// intersects. \return the moments of all
/// displacements.
Moments certifyPairs(const PlacedFeatures& placed, const ColliderSubstep& substep,
                     const ParticleView& particles, std::vector<FeaturePair>& pairs);

}  // namespace cloth_sim
