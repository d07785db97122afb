#pragma once
/// \file The registry rows of all methods; each is defined in the method's own file.

#include "cloth_sim/solver/registry.h"

namespace cloth_sim {

SolverInfo explicitEulerInfo();
SolverInfo implicitEulerInfo();
SolverInfo pbdInfo();
SolverInfo projectiveInfo();
SolverInfo rungeKuttaInfo();
SolverInfo symplecticEulerInfo();
SolverInfo trBdf2Info();
SolverInfo verletInfo();
SolverInfo xpbdInfo();

/// The parameter that every method has: substeps of a step.
SolverParameter substepsParameter(int defaultValue);
/// ... and its value.
int substepsOf(const SolverParameters& parameters);

}  // namespace cloth_sim
