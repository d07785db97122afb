#include "cloth_sim/solver/step_guard.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "step_count.h"

namespace cloth_sim {
namespace {

/// Limit of stability of the method that `stableStep` is about.
constexpr double kLimitOfStableStep = 2.0;

}  // namespace

int stableSubsteps(const SolverInfo& info, const FastestMode& mode, double dt) {
  if (std::isinf(info.stabilityLimit)) return 1;
  const bool needsDamping = info.stabilityLimit <= 0.0;
  const double longest = needsDamping ? stableForwardStep(mode)
                                      : info.stabilityLimit / kLimitOfStableStep * stableStep(mode);
  if (longest <= 0.0) {
    throw std::invalid_argument("solver.method: " + info.name +
                                " is stable at no step where anything is undamped");
  }
  return stepCount(dt / longest);
}

SolverParameters guardStep(StepGuard guard, const SolverInfo& info, const FastestMode& mode,
                           double dt, SolverParameters parameters) {
  if (guard == StepGuard::kAllow) return parameters;
  const int needed = stableSubsteps(info, mode, dt);
  double& substeps = parameters.at("substeps");
  if (substeps >= needed) return parameters;
  if (guard == StepGuard::kRefuse) {
    throw std::invalid_argument("solver.substeps: " + info.name + " is stable with " +
                                std::to_string(needed) + " or more (got " +
                                std::to_string(static_cast<int>(substeps)) + ")");
  }
  substeps = needed;
  return parameters;
}

}  // namespace cloth_sim
