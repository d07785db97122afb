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

void Clearance::build(const Model& model, const FacePairSearch& search, double margin) {
  margin_ = margin;
  sheets_.clear();
  if (model.particleCount() != undamagedCount(model)) return;
  for (std::size_t cloth = 0; cloth < model.cloths.size(); ++cloth) {
    if (addSheet(model, cloth, search.trees()[cloth])) continue;
    sheets_.clear();
    return;
  }
  faces_ = model.mesh.faces();
  inverseRest_ = &search.allowance().inverseRest();
  const auto vertices = static_cast<std::size_t>(model.particleCount());
  for (VectorArray* array : {&last_, &now_}) array->resize(vertices);
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();  // equal to no place
  last_.set(0, Vec3::Constant(kUnknown));
}

/// \return whether the cloth can be checked: it is a grid with a cell in each bucket of its tree.
bool Clearance::addSheet(const Model& model, std::size_t cloth, const MaterialTree& tree) {
  const ClothPart& part = model.cloths[cloth];
  if (!isAsItsGrid(model.mesh, part)) return false;
  const Grid& grid = *part.grid;
  const MaterialLevel& buckets = tree.level(0);
  const bool hasCells = buckets.columns == grid.columns - 1 && buckets.rows == grid.rows - 1;
  if (!hasCells || buckets.columns < kTileSide) return false;
  Sheet& sheet = sheets_.emplace_back();
  sheet.tree = &tree;
  sheet.firstTile = {part.firstVertex, 0, grid.columns, {grid.spacingU(), grid.spacingV()}};
  sheet.levels.resize(tree.levelCount());
  for (int k = 0; k < tree.levelCount(); ++k) {
    sheet.levels[k].resize(tree.level(k).columns, tree.level(k).rows);
  }
  const std::int32_t tiles = sheet.levels[kTileLevel].count();
  sheet.bounds.resize(tiles);
  sheet.lastBounds.resize(tiles);
  sheet.isDivided.resize(tiles);
  return true;
}

bool Clearance::begin(const ParticleView& particles) {
  if (!isUsable()) return false;
  common_ = Vec3::Zero();
  if (!isLastAt(particles)) {
    parallelForEach(last_.x.size(), kCopyGrain,
                    [&](VertexId v) { last_.set(v, particles.startAt(particles.slot(v))); });
    bound(last_, &Sheet::lastBounds);
  }
  return areAllClear(last_, &Sheet::lastBounds);
}

/// Tells whether a step begins where bounds were found last.
bool Clearance::isLastAt(const ParticleView& particles) const {
  for (VertexId v = 0; v < static_cast<VertexId>(last_.x.size()); ++v) {
    if (particles.startAt(particles.slot(v)) != last_.at(v)) return false;
  }
  return true;
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
    parallelForEach(sheet.bounds.size(), kTileGrain, [&](std::int32_t k) {
      (sheet.*bounds)[k] = boundTile(sheet.tile(k), axesAt(x, 0));
    });
  }
}

/// Joins the bounds of tiles at both ends, and brings the nodes above the tiles up to date.
void Clearance::join(const std::vector<TileBounds>& endBounds, Sheet& sheet) {
  MaterialLevel& tiles = sheet.levels[kTileLevel];
  for (std::int32_t k = 0; k < tiles.count(); ++k) {
    const TileBounds& end = endBounds[k];
    const TileBounds& last = sheet.lastBounds[k];
    tiles.boxes[k] = widened({last.box.low.cwiseMin(end.box.low - common_),
                              last.box.high.cwiseMax(end.box.high - common_)});
    tiles.balls[k] = last.ball;
    tiles.balls[k].add(end.ball);
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

QuickBox Clearance::widened(const Box& box) const {
  const Vec3 margin = Vec3::Constant(margin_);
  return QuickBox({box.low - margin, box.high + margin});
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
          boundBucket(node, sheet);
        } else {
          level.join(sheet.levels[k - 1], node);
        }
        level.doubtProofs(node);
      }
    }
  }
}

void Clearance::boundBucket(std::int32_t bucket, Sheet& sheet) const {
  Box box;
  for (const FaceId f : sheet.tree->owned(bucket)) {
    for (const VertexId v : faces_[f]) {
      for (const Vec3& x : {last_.at(v), Vec3(end_->at(v) - common_)}) box.add({x, x});
    }
  }
  GradientBall ball;
  for (const FaceId f : sheet.tree->overlapping(bucket)) {
    for (const VectorArray* x : {&std::as_const(last_), end_}) {
      const Vec3 at = x->at(faces_[f][0]);
      ball.add(
          {Gradient::of(x->at(faces_[f][1]) - at, x->at(faces_[f][2]) - at, (*inverseRest_)[f]),
           0.0});
    }
  }
  sheet.levels.front().boxes[bucket] = widened(box);
  sheet.levels.front().balls[bucket] = ball;
}

}  // namespace cloth_sim
