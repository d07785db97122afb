#include "cloth_sim/mesh/grid.h"

#include <algorithm>
#include <array>
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

/// Adds the two faces of the cell whose first corner is vertex (i, j).
void addCell(const Grid& grid, int i, int j, std::vector<Face>& faces) {
  // Counter-clockwise, from the first end of the diagonal.
  std::array<VertexId, 4> corners{grid.vertex(i, j), grid.vertex(i + 1, j),
                                  grid.vertex(i + 1, j + 1), grid.vertex(i, j + 1)};
  if (grid.diagonals == Diagonals::kAlternating && (i + j) % 2 != 0) {
    std::rotate(corners.begin(), corners.begin() + 1, corners.end());
  }
  faces.push_back({corners[0], corners[1], corners[2]});
  faces.push_back({corners[0], corners[2], corners[3]});
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
    for (int i = 0; i + 1 < grid.columns; ++i) addCell(grid, i, j, faces);
  }
  return TriangleMesh(std::move(material), std::move(faces));
}

}  // namespace cloth_sim
