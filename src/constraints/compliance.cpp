#include "compliance.h"

#include <limits>

namespace cloth_sim {

Compliance complianceOf(const SpringParameters& parameters, double h) {
  if (parameters.stiffness <= 0.0) return {std::numeric_limits<double>::infinity(), 0.0};
  return {1.0 / (parameters.stiffness * h * h), parameters.damping / (parameters.stiffness * h)};
}

void setCompliances(const SpringParameterTable& parameters, double h, Compliances& compliances) {
  compliances.alpha.resize(parameters.size());
  compliances.lag.resize(parameters.damped() ? parameters.size() : 0);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const Compliance of = complianceOf(parameters[static_cast<std::int32_t>(k)], h);
    compliances.alpha[k] = of.alpha;
    if (parameters.damped()) compliances.lag[k] = of.lag;
  }
}

}  // namespace cloth_sim
