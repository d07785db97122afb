#include "drape_radius.h"

namespace cloth_sim {

double borderRadius(const Grid& grid, const std::vector<Vec3>& positions) {
  const int right = grid.columns - 1, top = grid.rows - 1;
  double sum = 0.0;
  const auto add = [&](int i, int j) {
    sum += positions[static_cast<std::size_t>(grid.vertex(i, j))].head<2>().norm();
  };
  for (int k = 0; k < right; ++k) {
    add(k, 0);
    add(k + 1, top);
  }
  for (int k = 0; k < top; ++k) {
    add(right, k);
    add(0, k + 1);
  }
  return sum / (2.0 * (right + top));
}

}  // namespace cloth_sim
