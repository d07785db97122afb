#include "compliance.h"

#include <limits>

namespace cloth_sim {

Compliance complianceOf(const SpringParameters& law, double h) {
  if (law.stiffness <= 0.0) return {std::numeric_limits<double>::infinity(), 0.0};
  return {1.0 / (law.stiffness * h * h), law.damping / (law.stiffness * h)};
}

void setCompliances(const SpringParameterTable& laws, double h, Compliances& compliances) {
  compliances.alpha.resize(laws.size());
  compliances.lag.resize(laws.damped() ? laws.size() : 0);
  for (std::size_t k = 0; k < laws.size(); ++k) {
    const Compliance of = complianceOf(laws[static_cast<std::int32_t>(k)], h);
    compliances.alpha[k] = of.alpha;
    if (laws.damped()) compliances.lag[k] = of.lag;
  }
}

}  // namespace cloth_sim
