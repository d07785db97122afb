#include "cloth_sim/mesh/grid.h"

#include <stdexcept>

namespace cloth_sim {
namespace {

/// Divides a side [m] into cells and rounds the result to a multiple of the precision of eight
/// sides, so that its multiples are exact up to there. Eight, because further cloths lie beside the
/// first one in material coordinates.
double cellSize(double side, int cells) {
  const double far = 8.0 * side;
  return (far + side / cells) - far;
}

}  // namespace

double Grid::spacingU() const { return cellSize(width, columns - 1); }

double Grid::spacingV() const { return cellSize(height, rows - 1); }

TriangleMesh makeGridMesh(const Grid& grid) {
  if (grid.columns < 2 || grid.rows < 2) {
    throw std::invalid_argument("a grid needs at least 2 x 2 vertices");
  }
  if (!(grid.width > 0.0) || !(grid.height > 0.0)) {
    throw std::invalid_argument("a grid needs a positive width and height");
  }
  std::vector<Vec2> material;
  material.reserve(static_cast<std::size_t>(grid.columns) * grid.rows);
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      material.push_back(grid.material(i, j));
    }
  }
  std::vector<Face> faces;
  faces.reserve(static_cast<std::size_t>(grid.columns - 1) * (grid.rows - 1) * 2);
  for (int j = 0; j + 1 < grid.rows; ++j) {
    for (int i = 0; i + 1 < grid.columns; ++i) {
      const VertexId corner = grid.vertex(i, j);
      const VertexId opposite = grid.vertex(i + 1, j + 1);
      faces.push_back({corner, grid.vertex(i + 1, j), opposite});
      faces.push_back({corner, opposite, grid.vertex(i, j + 1)});
    }
  }
  return TriangleMesh(std::move(material), std::move(faces));
}

}  // namespace cloth_sim
