#pragma once
/// \file What to do about a step that a method does not stand.

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/solver/registry.h"

namespace cloth_sim {

/// For substeps longer than a method is surely stable with.
enum class StepGuard {
  kAllow,      ///< they are taken
  kSubdivide,  ///< there are more of them instead
  kRefuse,     ///< the scene is refused
};

/// What the guard over the steps has done.
struct GuardRecord {
  int configuredSubsteps = 0;  ///< what the scene asks for
  int chosenSubsteps = 0;      ///< what it got when it was loaded
  int redone = 0;              ///< attempts at a step that were rolled back
  int finest = 1;              ///< most times that a step was divided further
  double lastRedone = 0.0;     ///< simulated time of the last of them [s]

  template <class Archive>
  void serialize(Archive& archive) {
    archive(configuredSubsteps, chosenSubsteps, redone, finest, lastRedone);
  }
};

/// Substeps by which `info`'s method is stable in steps of `dt`, from its limit of stability and
/// the fastest mode; 1 if it has no limit. \throws std::invalid_argument if no number of substeps
/// makes it stable.
int stableSubsteps(const SolverInfo& info, const FastestMode& mode, double dt);

/// The parameters of a method as the guard leaves them.
/// \param parameters  complete.
/// \throws std::invalid_argument with what is wrong and how many substeps it takes.
SolverParameters guardStep(StepGuard guard, const SolverInfo& info, const FastestMode& mode,
                           double dt, SolverParameters parameters);

}  // namespace cloth_sim
