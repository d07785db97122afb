#pragma once
/// \file Which of several runs nobody would choose another one over.

#include <cstddef>
#include <vector>

namespace cloth_sim {

struct CostAndError {
  double cost = 0.0;
  double error = 0.0;
};

/// Indices of the points that no other one beats, by ascending cost: a point is beaten by one that
/// is no worse in both and better in one. Of equal points the first is kept; points that are not
/// finite are on no front.
std::vector<std::size_t> paretoFront(const std::vector<CostAndError>& points);

}  // namespace cloth_sim
