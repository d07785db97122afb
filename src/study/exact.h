#pragma once
/// \file References of smooth scenes by SUNDIALS CVODE. Only the study links this library
/// (cloth_exact). Built without SUNDIALS, it offers no references.

#include "reference.h"

namespace cloth_sim {

/// Tells whether the library was built with CVODE.
bool canIntegrateExactly();

/// Solves the scene's equations of motion (springs, dashpots, drag, gravity, pins at rest) by
/// Adams' methods of variable step and order, to a relative tolerance of 1e-10. The reference's own
/// error is its difference from a run at 1e-8.
/// \throws std::runtime_error without CVODE, or if it fails.
/// \throws std::invalid_argument if the scene is not smooth.
Reference integrateExactly(const StudyScene& study);

}  // namespace cloth_sim
