#include "bending_row_sums.h"

#include <array>
#include <cmath>

namespace cloth_sim {

std::vector<double> bendingRowSums(const Model& model, const std::vector<double>& scale) {
  std::vector<double> rows(scale.size(), 0.0);
  for (const PlateElement& element : model.bending.elements()) {
    const auto count = static_cast<std::size_t>(element.count);
    std::array<double, PlateElement::kMostVertices> scaled{};  // weights
    double sum = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      scaled[k] = std::abs(element.weight[k]) * scale[static_cast<std::size_t>(element.vertex[k])];
      sum += scaled[k];
    }
    for (std::size_t k = 0; k < count; ++k) {
      rows[static_cast<std::size_t>(element.vertex[k])] += element.stiffness * scaled[k] * sum;
    }
  }
  return rows;
}

}  // namespace cloth_sim
