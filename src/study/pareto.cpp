#include "pareto.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cloth_sim {

std::vector<std::size_t> paretoFront(const std::vector<CostAndError>& points) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (std::isfinite(points[k].cost) && std::isfinite(points[k].error)) order.push_back(k);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (points[a].cost != points[b].cost) return points[a].cost < points[b].cost;
    return points[a].error < points[b].error;
  });
  std::vector<std::size_t> front;
  double best = std::numeric_limits<double>::infinity();
  for (const std::size_t k : order) {
    if (points[k].error >= best) continue;
    best = points[k].error;
    front.push_back(k);
  }
  return front;
}

}  // namespace cloth_sim
