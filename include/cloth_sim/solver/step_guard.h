#pragma once
/// \file What to do about a step that a method does not stand.

#include "cloth_sim/solver/registry.h"

namespace cloth_sim {

/// For substeps longer than a method is surely stable with.
enum class StepGuard {
  kAllow,      ///< they are taken
  kSubdivide,  ///< there are more of them instead
  kRefuse,     ///< the scene is refused
};

/// Substeps by which `info`'s method is surely stable in steps of `dt`, from its limit of stability
/// and Gershgorin's bound on the fastest mode (stableStep); 1 if it has no limit.
/// \throws std::invalid_argument if no number of substeps makes it stable.
int stableSubsteps(const SolverInfo& info, const Model& model, double dt);

/// The parameters of a method as the guard leaves them.
/// \param parameters  complete.
/// \throws std::invalid_argument with what is wrong and how many substeps it takes.
SolverParameters guardStep(StepGuard guard, const SolverInfo& info, const Model& model, double dt,
                           SolverParameters parameters);

}  // namespace cloth_sim
