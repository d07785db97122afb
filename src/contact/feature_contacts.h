#pragma once
/// \file Contact of the sharp corners and edges of a mesh with the faces and edges of the cloth.

#include <vector>

#include "cloth_sim/contact/contacts.h"
#include "collider_substep.h"
#include "feature_meeting.h"

namespace cloth_sim {

/// Moves faces and edges of the cloth away from corners and edges of the mesh, with friction, as
/// displacements of their particles in proportion to their weights and inverse masses. Corners and
/// edges stay on the side of the cloth where they are at the start of the substep; paths are swept
/// as straight lines in the frame of the collider. Faces of the cloth that a corner of a closed
/// mesh has pierced at the start of the step leave it at up to `kDepenetrationSpeed`.
/// \param placed  at the end of the substep.
/// \param margin  distance that cloth keeps [m].
/// \return the moments of all displacements.
Moments projectPairs(const PlacedFeatures& placed, const ColliderSubstep& substep, double margin,
                     const ParticleView& particles, std::vector<FeaturePair>& pairs);

/// Lets the particles of pairs that would still pass through each other move along with the
/// collider: then none does, unless held particles force it. Does nothing while any pair
/// intersects.
/// \return the moments of all displacements.
Moments certifyPairs(const PlacedFeatures& placed, const ColliderSubstep& substep,
                     const ParticleView& particles, std::vector<FeaturePair>& pairs);

}  // namespace cloth_sim
