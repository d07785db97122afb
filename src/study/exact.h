#pragma once
/// \file References of smooth scenes by SUNDIALS CVODE. Of the study only: the simulation does not
/// link it. A library of its own (cloth_exact); built without SUNDIALS, it says so.

#include "reference.h"

namespace cloth_sim {

/// Whether CVODE was there when this was built.
bool canIntegrateExactly();

/// Solves the scene's equations of motion (springs, dashpots, drag, gravity, pins at rest) by
/// Adams' methods of variable step and order, to a relative tolerance of 1e-10. The reference's own
/// error is its difference from a run at 1e-8. \throws std::runtime_error without CVODE, or if it
/// fails; std::invalid_argument if the scene is
///         not smooth.
Reference integrateExactly(const StudyScene& study);

}  // namespace cloth_sim
