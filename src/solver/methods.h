#pragma once
/// \file The methods: a new one is a file that ends with its `SolverInfo name()`, and a row here.

#include "cloth_sim/solver/registry.h"

namespace cloth_sim {

/// The function of each method's file that describes it, sorted by the name of the method.
#define CLOTH_SIM_METHODS(ROW) \
  ROW(explicitEulerInfo)       \
  ROW(implicitEulerInfo)       \
  ROW(lineXpbdInfo)            \
  ROW(pbdInfo)                 \
  ROW(projectiveInfo)          \
  ROW(rungeKuttaInfo)          \
  ROW(symplecticEulerInfo)     \
  ROW(trBdf2Info)              \
  ROW(verletInfo)              \
  ROW(xpbdInfo)

#define CLOTH_SIM_DECLARE_METHOD(name) SolverInfo name();
CLOTH_SIM_METHODS(CLOTH_SIM_DECLARE_METHOD)
#undef CLOTH_SIM_DECLARE_METHOD

/// The parameter that every method has: substeps of a step.
SolverParameter substepsParameter(int defaultValue);
/// ... and its value.
int substepsOf(const SolverParameters& parameters);

}  // namespace cloth_sim
