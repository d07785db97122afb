#pragma once
/// \file How long a step explicit methods can take.

#include "cloth_sim/cloth/model.h"
#include "cloth_sim/cloth/state.h"

namespace cloth_sim {

/// What limits an explicit step.
struct FastestMode {
  double squared = 0.0;  ///< of its angular frequency omega [1/s^2]
  double retardation =
      0.0;  ///< largest of any spring or bending element, dashpot over stiffness [s]
};

/// An upper bound, whatever the state: Gershgorin's circles, omega^2 <= max over particles of
/// (2 / m) sum k of its springs, and what bending adds. Springs that do not all point the same way
/// allow more.
FastestMode boundFastestMode(const Model& model);

/// An estimate for the state as it is, with a safety margin of 10 % on omega^2, and never above the
/// bound: power iteration on the mass-weighted stiffness, matrix-free. It holds as long as the
/// cloth does not crumple so that springs line up.
FastestMode estimateFastestMode(const Model& model, const State& state);

/// Longest stable step of the symplectic Euler method [s]: where h^2 omega^2 + 2 h tau omega^2 = 4,
/// which is 2 / omega without damping, and then holds for Verlet too. Infinity without springs.
double stableStep(const FastestMode& mode);

/// The same by Gershgorin's bound: surely stable.
double stableStep(const Model& model);

/// Longest stable step of forward Euler [s]: 2 zeta / omega = tau for modes that oscillate, less if
/// the fastest creeps (zeta > 1). 0 without damping.
double stableForwardStep(const FastestMode& mode);

}  // namespace cloth_sim
