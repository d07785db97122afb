#pragma once
/// \file Graph colouring of springs: no two springs of a colour share a particle.

#include <vector>

#include "cloth_sim/cloth/model.h"

namespace cloth_sim {

/// Colours springs greedily; each prefers the colour that it would have on a regular grid. A grid
/// needs twelve colours, numbered so that colours which share few rows are neighbours.
/// \param slots  spring slots to colour; springs that are gone get no colour.
/// \return spring slots by colour; no colour is empty.
std::vector<std::vector<std::int32_t>> colourSprings(const Model& model,
                                                     const std::vector<std::int32_t>& slots);

}  // namespace cloth_sim
