#pragma once
/// \file How far springs give way to corrections.

#include <vector>

#include "spring_parameters.h"

namespace cloth_sim {

/// What a spring gives way in a substep: f along it moves its ends until C + alpha f = 0, or with
/// damping C + lag dC + alpha f = 0, where dC is what C has changed by in this substep. The update
/// of Macklin et al. 2016, eqs. 18 and 26, with one iteration.
struct Compliance {
  double alpha = 0.0;  ///< 1 / (k h^2) [1/kg]; infinite where the spring is gone
  double lag = 0.0;    ///< c / (k h) [-]
};
/// \param h  length of the substep [s].
Compliance complianceOf(const SpringParameters& parameters, double h);

/// The same for many parameters, side by side.
struct Compliances {
  std::vector<double> alpha;
  std::vector<double> lag;  ///< nothing where no spring is damped
};
void setCompliances(const SpringParameterTable& parameters, double h, Compliances& compliances);

}  // namespace cloth_sim
