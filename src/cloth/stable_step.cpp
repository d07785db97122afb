#include "cloth_sim/cloth/stable_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cloth_sim {

double stableStep(const Model& model) {
  std::vector<double> stiffness(static_cast<std::size_t>(model.particleCount()), 0.0);
  double retardation = 0.0;
  for (const Spring& spring : model.springs.slots()) {
    if (!spring.exists() || spring.stiffness <= 0.0) continue;
    stiffness[spring.a] += spring.stiffness;
    stiffness[spring.b] += spring.stiffness;
    retardation = std::max(retardation, spring.damping / spring.stiffness);
  }
  std::vector<double> bending(stiffness.size(), 0.0);
  for (const BendElement& element : model.bending.elements()) {
    double sum = 0.0;
    for (double weight : element.weight) sum += std::abs(weight);
    for (int k = 0; k < element.count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      bending[element.vertex[i]] += element.stiffness * std::abs(element.weight[i]) * sum;
    }
  }
  if (!model.bending.empty()) retardation = std::max(retardation, model.fabric.damping);
  double squared = 0.0;
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    squared = std::max(squared, (2.0 * stiffness[v] + bending[v]) / model.mass[v]);
  }
  if (squared == 0.0) return std::numeric_limits<double>::infinity();
  return std::sqrt(retardation * retardation + 4.0 / squared) - retardation;
}

}  // namespace cloth_sim
