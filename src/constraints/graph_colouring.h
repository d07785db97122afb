#pragma once
/// \file Springs in colours: no two of a colour share a particle.

#include <vector>

#include "cloth_sim/cloth/model.h"

namespace cloth_sim {

/// \return by colour, none of them empty: spring slots. On a grid few colours suffice, and those of
/// springs that share few rows follow each other.
/// \param slots  those that are gone have no colour.
std::vector<std::vector<std::int32_t>> colourSprings(const Model& model,
                                                     const std::vector<std::int32_t>& slots);

}  // namespace cloth_sim
