#include "clearance.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "sampled_motion.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Level of the tiles, and buckets along their sides.
constexpr int kTileLevel = 2;
constexpr int kTileSide = 1 << kTileLevel;
static_assert(kTileSide == GridTile::kColumns);
constexpr std::int32_t kTileGrain = 32;
constexpr std::int32_t kCopyGrain = 4096;

/// Substeps, and time [s], between two checks: as many as are both.
constexpr int kLeastSubsteps = 10;
constexpr double kLeastTime = 1.0 / 120.0;

Place rootOf(const std::vector<MaterialLevel>& levels) {
  return {static_cast<int>(levels.size()) - 1, 0, 0};
}

/// The number of vertices before any edit.
std::int32_t undamagedCount(const Model& model) {
  return model.cloths.back().firstVertex + model.cloths.back().vertices;
}

/// Tells whether three vertices of a grid are corners of the same cell.
bool areInCell(const Grid& grid, const Face& numbers) {
  int low[2] = {grid.columns, grid.rows};
  int high[2] = {0, 0};
  for (const VertexId number : numbers) {
    const int at[2] = {number % grid.columns, number / grid.columns};
    for (int axis = 0; axis < 2; ++axis) {
      low[axis] = std::min(low[axis], at[axis]);
      high[axis] = std::max(high[axis], at[axis]);
    }
  }
  return high[0] - low[0] == 1 && high[1] - low[1] == 1;
}

/// Tells whether the faces of a cloth are those of its grid, however its cells are divided.
/// \param mesh  with as many vertices as before any edit.
bool isAsItsGrid(const TriangleMesh& mesh, const ClothPart& cloth) {
  if (!cloth.grid) return false;
  const Grid& grid = *cloth.grid;
  const double tolerance = 1e-9 * std::min(grid.spacingU(), grid.spacingV());
  for (VertexId n = 0; n < cloth.vertices; ++n) {
    const Vec2 at = grid.material(n % grid.columns, n / grid.columns);
    const Vec2 is = mesh.material(cloth.firstVertex + n) - Vec2(cloth.materialOffset, 0.0);
    if (!((is - at).norm() < tolerance)) return false;
  }
  const auto isNumber = [&](VertexId n) { return n >= 0 && n < cloth.vertices; };
  std::int32_t faces = 0;
  for (Face face : mesh.faces()) {
    for (VertexId& v : face) v -= cloth.firstVertex;
    if (!std::all_of(face.begin(), face.end(), isNumber)) continue;
    if (!areInCell(grid, face)) return false;
    ++faces;
  }
  return faces == 2 * (grid.columns - 1) * (grid.rows - 1);
}

}  // namespace

/// The k-th tile. The last one of a row of tiles overlaps the one before.
GridTile Clearance::Sheet::tile(std::int32_t k) const {
  const MaterialLevel& buckets = levels.front();
  const Place at = levels[kTileLevel].placeOf(0, k);
  const int row = kTileSide * at.j;
  GridTile of = firstTile;
  of.first += row * of.stride + std::min(kTileSide * at.i, buckets.columns - kTileSide);
  of.rows = std::min(kTileSide, buckets.rows - row) + 1;
  return of;
}

VertexId Clearance::Sheet::cornerOf(std::int32_t cell) const {
  const Place at = levels.front().placeOf(0, cell);
  return firstTile.first + at.j * firstTile.stride + at.i;
}

int Clearance::interval(double h) {
  constexpr double kRounding = 1e-9;
  return std::max(kLeastSubsteps, static_cast<int>(kLeastTime / h + kRounding));
}

void Clearance::build(const Model& model, double margin) {
  margin_ = margin;
  sheets_.clear();
  if (model.particleCount() != undamagedCount(model)) return;
  for (std::size_t cloth = 0; cloth < model.cloths.size(); ++cloth) {
    if (addSheet(model, cloth)) continue;
    sheets_.clear();
    return;
  }
  const auto vertices = static_cast<std::size_t>(model.particleCount());
  for (VectorArray* array : {&last_, &now_}) array->resize(vertices);
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();  // equal to no place
  last_.set(0, Vec3::Constant(kUnknown));
}

/// \return whether the cloth can be checked: it is a grid that is as wide as a tile.
bool Clearance::addSheet(const Model& model, std::size_t cloth) {
  const ClothPart& part = model.cloths[cloth];
  if (!isAsItsGrid(model.mesh, part)) return false;
  const Grid& grid = *part.grid;
  if (grid.columns <= kTileSide) return false;
  Sheet& sheet = sheets_.emplace_back();
  sheet.firstTile = {part.firstVertex, 0, grid.columns, {grid.spacingU(), grid.spacingV()}};
  forLevels(grid.columns - 1, grid.rows - 1,
            [&](int columns, int rows) { sheet.levels.emplace_back().resize(columns, rows); });
  const std::int32_t tiles = sheet.levels[kTileLevel].count();
  sheet.bounds.resize(tiles);
  sheet.lastBounds.resize(tiles);
  sheet.isDivided.resize(tiles);
  return true;
}

bool Clearance::isClearAt(const std::vector<Vec3>& x) {
  return beginAt([&](VertexId v) -> const Vec3& { return x[v]; });
}

bool Clearance::begin(const ParticleView& particles) {
  return beginAt([&](VertexId v) { return particles.startAt(particles.slot(v)); });
}

/// Bounds are those of the last check where it ended there.
template <typename PlaceOf>
bool Clearance::beginAt(const PlaceOf& placeOf) {
  if (!isUsable()) return false;
  common_ = Vec3::Zero();
  const auto vertices = static_cast<VertexId>(last_.x.size());
  VertexId same = 0;
  while (same < vertices && placeOf(same) == last_.at(same)) ++same;
  if (same < vertices) {
    parallelForEach(last_.x.size(), kCopyGrain, [&](VertexId v) { last_.set(v, placeOf(v)); });
    bound(last_, &Sheet::lastBounds);
  }
  return areAllClear(last_, &Sheet::lastBounds);
}

bool Clearance::follow(const ParticleView& particles) {
  common_ = sampledMotion(now_.x.size(), [&](VertexId v) -> Vec3 {
    return particles.at(particles.slot(v)) - last_.at(v);
  });
  parallelForEach(now_.x.size(), kCopyGrain,
                  [&](VertexId v) { now_.set(v, particles.at(particles.slot(v))); });
  bound(now_, &Sheet::bounds);
  if (!areAllClear(now_, &Sheet::bounds)) return false;
  std::swap(last_, now_);
  for (Sheet& sheet : sheets_) std::swap(sheet.lastBounds, sheet.bounds);
  return true;
}

/// Looks for parts that might touch on the way from the last check to an end.
/// \param end        positions there, by vertex [m].
/// \param endBounds  bounds of the tiles there.
bool Clearance::areAllClear(const VectorArray& end, std::vector<TileBounds> Sheet::*endBounds) {
  end_ = &end;
  for (Sheet& sheet : sheets_) join(sheet.*endBounds, sheet);
  for (std::size_t a = 0; a < sheets_.size(); ++a) {
    const Place root = rootOf(sheets_[a].levels);
    if (!isClear(root, root, sheets_[a])) return false;
    for (std::size_t b = a + 1; b < sheets_.size(); ++b) {
      if (!areClear(root, sheets_[a], rootOf(sheets_[b].levels), sheets_[b])) return false;
    }
  }
  return true;
}

/// Finds the bounds of all tiles at one end of the way. \param x  positions, by vertex [m].
void Clearance::bound(const VectorArray& x, std::vector<TileBounds> Sheet::*bounds) {
  for (Sheet& sheet : sheets_) {
    parallelForEach(sheet.bounds.size(), kTileGrain,
                    [&](std::int32_t k) { (sheet.*bounds)[k] = boundTile(sheet.tile(k), x); });
  }
}

/// Joins the bounds of tiles at both ends, and brings the nodes above the tiles up to date.
void Clearance::join(const std::vector<TileBounds>& endBounds, Sheet& sheet) {
  MaterialLevel& tiles = sheet.levels[kTileLevel];
  for (std::int32_t k = 0; k < tiles.count(); ++k) {
    joinEnds(sheet.lastBounds[k], endBounds[k], k, tiles);
  }
  tiles.forgetProofs();
  std::fill(sheet.isDivided.begin(), sheet.isDivided.end(), 0);
  for (std::size_t k = kTileLevel + 1; k < sheet.levels.size(); ++k) {
    for (std::int32_t node = 0; node < sheet.levels[k].count(); ++node) {
      sheet.levels[k].join(sheet.levels[k - 1], node);
    }
    sheet.levels[k].forgetProofs();
  }
}

/// Sets the bounds of a node to those at both ends of the way, with the margin.
void Clearance::joinEnds(const TileBounds& last, const TileBounds& end, std::int32_t node,
                         MaterialLevel& level) const {
  const Vec3 margin = Vec3::Constant(margin_);
  level.boxes[node] = QuickBox({last.box.low.cwiseMin(end.box.low - common_) - margin,
                                last.box.high.cwiseMax(end.box.high - common_) + margin});
  level.balls[node] = last.ball;
  level.balls[node].add(end.ball);
}

/// Tells whether two nodes of a cloth do not touch, or a node itself. Where a position is not
/// finite boxes say nothing, but no ball of the node proves anything either.
bool Clearance::isClear(const Place& a, const Place& b, Sheet& sheet) {
  const MaterialLevel& level = sheet.levels[a.level];
  const int nodeA = level.node(a.i, a.j);
  const int nodeB = level.node(b.i, b.j);
  if (nodeA != nodeB && !level.boxes[nodeA].meets(level.boxes[nodeB])) return true;
  if (level.isSmooth(a, b)) return true;
  if (a.level == 0) return false;
  std::array<Place, 4> partsA, partsB;
  const int countA = partsOf(a, sheet, partsA);
  const int countB = partsOf(b, sheet, partsB);
  for (int k = 0; k < countA; ++k) {
    for (int m = nodeA == nodeB ? k : 0; m < countB; ++m) {
      if (!isClear(partsA[k], partsB[m], sheet)) return false;
    }
  }
  return true;
}

/// Tells whether nodes of two cloths do not touch.
bool Clearance::areClear(const Place& a, Sheet& sheetA, const Place& b, Sheet& sheetB) {
  const auto boxOf = [](const Place& at, const Sheet& sheet) -> const QuickBox& {
    const MaterialLevel& level = sheet.levels[at.level];
    return level.boxes[level.node(at.i, at.j)];
  };
  if (!boxOf(a, sheetA).meets(boxOf(b, sheetB))) return true;
  if (a.level == 0 && b.level == 0) return false;
  std::array<Place, 4> parts;
  const bool dividesA = a.level >= b.level;
  const int count = dividesA ? partsOf(a, sheetA, parts) : partsOf(b, sheetB, parts);
  for (int k = 0; k < count; ++k) {
    if (!(dividesA ? areClear(parts[k], sheetA, b, sheetB)
                   : areClear(a, sheetA, parts[k], sheetB))) {
      return false;
    }
  }
  return true;
}

/// Lists the parts of a node, up to date.
int Clearance::partsOf(const Place& place, Sheet& sheet, std::array<Place, 4>& out) {
  if (place.level == kTileLevel) divideAround(place, sheet);
  return sheet.levels[place.level - 1].partsOf(place, out);
}

/// Brings what lies below a tile and its neighbours up to date: parts of neighbours are proven
/// together.
void Clearance::divideAround(const Place& tile, Sheet& sheet) {
  const MaterialLevel& tiles = sheet.levels[kTileLevel];
  for (int j = std::max(0, tile.j - 1); j < std::min(tile.j + 2, tiles.rows); ++j) {
    for (int i = std::max(0, tile.i - 1); i < std::min(tile.i + 2, tiles.columns); ++i) {
      std::uint8_t& isDivided = sheet.isDivided[tiles.node(i, j)];
      if (isDivided == 0) divide({kTileLevel, i, j}, sheet);
      isDivided = 1;
    }
  }
}

/// Brings the nodes below a tile up to date, the smallest first.
void Clearance::divide(const Place& tile, Sheet& sheet) {
  for (int k = 0; k < kTileLevel; ++k) {
    MaterialLevel& level = sheet.levels[k];
    const int side = 1 << (kTileLevel - k);
    for (int j = side * tile.j; j < std::min(side * (tile.j + 1), level.rows); ++j) {
      for (int i = side * tile.i; i < std::min(side * (tile.i + 1), level.columns); ++i) {
        const int node = level.node(i, j);
        if (k == 0) {
          refreshCell(node, sheet);
        } else {
          level.join(sheet.levels[k - 1], node);
        }
        level.doubtProofs(node);
      }
    }
  }
}

void Clearance::refreshCell(std::int32_t cell, Sheet& sheet) const {
  GridTile of = sheet.firstTile;
  of.first = sheet.cornerOf(cell);
  joinEnds(boundCell(of, last_), boundCell(of, *end_), cell, sheet.levels.front());
}

}  // namespace cloth_sim
