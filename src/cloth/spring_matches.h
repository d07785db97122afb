#pragma once
/// \file Springs before and after an edit of the mesh: which one continues which.

#include <vector>

#include "cloth_sim/cloth/spring_network.h"

namespace cloth_sim {

/// A spring before an edit and the derived spring that continues it.
struct SpringMatch {
  std::int32_t slot = kNone;     ///< of the spring before; kNone: the derived one is new
  std::int32_t derived = kNone;  ///< index of the derived spring; kNone: the old one is gone
};

/// Matches springs by the vertices that they join and that support them. Several derived springs
/// match one old spring where an edit made copies of its ends: the one with the lowest index
/// continues it, which is the one that kept the original ends, if any did.
/// \param slots    of all springs before the edit.
/// \param old      slots of those around the vertices that it has touched.
/// \param derived  the springs that are there now.
/// \return every old and every derived spring once, in an order that depends on vertices only.
std::vector<SpringMatch> matchSprings(const SpringSlots& slots,
                                      const std::vector<std::int32_t>& old,
                                      const std::vector<Spring>& derived,
                                      const MeshChanges& changes);

/// The ids that vertices have after a removal, by their ids before it; kNone for removed ones.
/// \param vertexCount  after it.
std::vector<VertexId> newIdsAfter(const MeshChanges& changes, std::int32_t vertexCount);

/// The same spring between renumbered vertices; none if its first end was removed.
Spring renumbered(Spring spring, const std::vector<VertexId>& newId);

}  // namespace cloth_sim
