#pragma once
/// \file The step guard: what happens to a step beyond a method's stability limit.

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/solver/registry.h"

namespace cloth_sim {

/// The treatment of substeps beyond the stability limit.
enum class StepGuard {
  kAllow,      ///< takes them as they are
  kSubdivide,  ///< takes more and shorter ones
  kRefuse,     ///< refuses the scene
};

/// Counts of the guard's interventions.
struct GuardRecord {
  int configuredSubsteps = 0;  ///< substeps of a step that the scene asks for
  int chosenSubsteps = 0;      ///< substeps of a step that the guard chose at load
  int redone = 0;              ///< attempts at a step that were rolled back
  int finest = 1;              ///< largest factor by which a step was divided further
  double lastRedone = 0.0;     ///< simulated time of the last attempt rolled back [s]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(configuredSubsteps, chosenSubsteps, redone, finest, lastRedone);
  }
};

/// The least number of substeps with which a method is stable in steps of length `dt` [s]: from its
/// stability limit and the fastest mode of the cloth. 1 for an unconditionally stable method.
/// \throws std::invalid_argument if no number of substeps makes it stable.
int stableSubsteps(const SolverInfo& info, const FastestMode& mode, double dt);

/// Applies the guard to the parameters of a method.
/// \param parameters  complete (completeParameters).
/// \return the parameters, with more substeps if the guard subdivides.
/// \throws std::invalid_argument naming the substeps needed, if the guard refuses.
SolverParameters guardStep(StepGuard guard, const SolverInfo& info, const FastestMode& mode,
                           double dt, SolverParameters parameters);

}  // namespace cloth_sim
