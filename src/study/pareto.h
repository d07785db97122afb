#pragma once
/// \file The Pareto front of cost and error.

#include <cstddef>
#include <vector>

namespace cloth_sim {

struct CostAndError {
  double cost = 0.0;
  double error = 0.0;
};

/// Returns the indices of the points on the Pareto front, by ascending cost: no other point is at
/// most as large in both coordinates and smaller in one. Of equal points the first is kept; points
/// that are not finite are left out.
std::vector<std::size_t> paretoFront(const std::vector<CostAndError>& points);

}  // namespace cloth_sim
