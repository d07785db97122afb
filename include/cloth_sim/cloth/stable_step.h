#pragma once
/// \file How long a step explicit methods can take.

#include "cloth_sim/cloth/model.h"

namespace cloth_sim {

/// Longest stable step of the symplectic Euler method [s]: where h^2 omega^2 + 2 h tau omega^2 = 4,
/// which is 2 / omega without damping, and then holds for Verlet too. omega is bounded from above
/// by Gershgorin's circles, omega^2 <= max over particles of (2 / m) sum k of its springs; tau is
/// the largest retardation time of a spring, dashpot over stiffness. A lower bound: springs that do
/// not all point the same way allow more. Infinity without springs.
double stableStep(const Model& model);

}  // namespace cloth_sim
