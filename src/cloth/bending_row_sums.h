#pragma once
/// \file Row sums of the stiffness matrix of a bending energy, for circles of Gershgorin.

#include <vector>

#include "cloth_sim/cloth/model.h"

namespace cloth_sim {

/// Returns the sums of the absolute values in the rows of S K S, element by element, by vertex. K
/// is the stiffness matrix of the bending energy [N/m]; for that of some of its elements they are
/// bounds.
/// \param scale  the diagonal of S, by vertex.
std::vector<double> bendingRowSums(const Model& model, const std::vector<double>& scale);

}  // namespace cloth_sim
