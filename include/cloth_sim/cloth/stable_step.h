#pragma once
/// \file The longest stable step of explicit methods.

#include "cloth_sim/cloth/model.h"
#include "cloth_sim/cloth/state.h"

namespace cloth_sim {

/// The fastest mode of vibration, which limits an explicit step.
struct FastestMode {
  double squared = 0.0;      ///< square of its angular frequency omega [1/s^2]
  double retardation = 0.0;  ///< tau: largest dashpot over stiffness of any element [s]
};

/// Returns an upper bound for any state, by Gershgorin's circle theorem:
/// omega^2 <= max over particles of (2 sum k + b) / m, with k the stiffnesses of the springs of the
/// particle and b the absolute row sum of the bending stiffness. The bound is attained only if the
/// springs of a particle are parallel.
FastestMode boundFastestMode(const Model& model);

/// Returns an estimate for the given state: matrix-free power iteration on the mass-weighted
/// stiffness, with a margin of 10 % on omega^2, and never above the bound. It stays valid as long
/// as the cloth does not crumple so much that springs become parallel.
FastestMode estimateFastestMode(const Model& model, const State& state);

/// Returns the longest stable step h of symplectic Euler [s], where h^2 omega^2 + 2 h tau omega^2
/// = 4; infinity without springs. Without damping it is 2 / omega, which holds for Verlet too.
double stableStep(const FastestMode& mode);

/// Returns the longest stable step by Gershgorin's bound [s]: stable for any state.
double stableStep(const Model& model);

/// Returns the longest stable step of forward Euler [s]. With the damping ratio zeta = tau omega /
/// 2 it is 2 zeta / omega = tau for modes that oscillate, and less for overdamped ones (zeta > 1).
/// It is 0 without damping.
double stableForwardStep(const FastestMode& mode);

}  // namespace cloth_sim
