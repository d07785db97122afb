#pragma once
/// \file Colour groups and blocks: how coloured springs are divided for caches and threads.

#include <cstdint>
#include <functional>
#include <vector>

#include "cloth_sim/types.h"

namespace cloth_sim {

/// Particle slots that a spring joins.
struct SpringEnds {
  std::int32_t a = kNone;
  std::int32_t b = kNone;
};

/// Spring slots by colour. No two springs of a colour share a particle.
using Coloured = std::vector<std::vector<std::int32_t>>;

/// The springs of a colour group: for each block, by colour. Blocks share no particle.
using ColourGroupBlocks = std::vector<Coloured>;

/// Joins consecutive colours into groups and divides each group into blocks.
///
/// The springs of a group form connected components; whole components are gathered into blocks of
/// about 4096 springs, which stay in the first-level cache while all colours of the group pass over
/// them. A colour joins the group before it only as long as many small components remain:
/// otherwise threads would be idle, or fetch from each other's caches what they have just moved.
/// \param ends       by spring slot.
/// \param particles  number of particle slots.
/// \param visit      called for each group in order.
void forColourGroups(const Coloured& colours, const std::vector<SpringEnds>& ends,
                     std::int32_t particles,
                     const std::function<void(const ColourGroupBlocks&)>& visit);

}  // namespace cloth_sim
