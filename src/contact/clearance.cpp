#include "clearance.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "sampled_motion.h"
#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Level of the tiles: 4 x 4 buckets.
constexpr int kTileLevel = 2;
constexpr std::int32_t kTileGrain = 32;
constexpr std::int32_t kCopyGrain = 4096;

Place rootOf(const std::vector<MaterialLevel>& levels) {
  return {static_cast<int>(levels.size()) - 1, 0, 0};
}

}  // namespace

Tile Clearance::Sheet::tile(std::int32_t k) const {
  return {runs.data() + firstRun[k], firstRun[k + 1] - firstRun[k], faces.data() + firstFace[k],
          firstFace[k + 1] - firstFace[k]};
}

void Clearance::build(const Model& model, const FacePairSearch& search, double margin) {
  const std::vector<MaterialTree>& trees = search.trees();
  margin_ = margin;
  sheets_.clear();
  if (!std::all_of(trees.begin(), trees.end(), [](const auto& tree) { return tree.isWhole(); })) {
    return;
  }
  faces_ = model.mesh.faces();
  inverseRest_ = &search.allowance().inverseRest();
  const auto vertices = static_cast<std::size_t>(model.particleCount());
  for (VectorArray* array : {&last_, &now_}) array->resize(vertices);
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();  // equal to no place
  if (vertices > 0) last_.set(0, Vec3::Constant(kUnknown));
  for (const MaterialTree& tree : trees) {
    Sheet& sheet = sheets_.emplace_back();
    sheet.tree = &tree;
    sheet.tileLevel = std::min(kTileLevel, tree.levelCount() - 1);
    sheet.levels.resize(tree.levelCount());
    for (int k = 0; k < tree.levelCount(); ++k) {
      sheet.levels[k].resize(tree.level(k).columns, tree.level(k).rows);
    }
    const std::int32_t tiles = sheet.levels[sheet.tileLevel].count();
    sheet.firstRun.assign(1, 0);
    sheet.firstFace.assign(1, 0);
    for (std::int32_t tile = 0; tile < tiles; ++tile) addTile(tile, sheet);
    sheet.bounds.resize(tiles);
    sheet.lastBounds.resize(tiles);
    sheet.isDivided.resize(tiles);
  }
}

/// Lists the faces of a tile, those side by side as runs.
void Clearance::addTile(std::int32_t tile, Sheet& sheet) const {
  const std::vector<FaceId> faces = facesOf(tile, sheet);
  std::vector<FaceId> others;
  for (std::size_t k = 0; k < faces.size();) {
    if (k + kLanes <= faces.size() && isRun(&faces[k])) {
      sheet.runs.push_back(runFrom(faces[k]));
      k += kLanes;
    } else {
      others.push_back(faces[k++]);
    }
  }
  while (others.size() % kLanes != 0) others.push_back(others.back());
  for (std::size_t k = 0; k < others.size(); k += kLanes) {
    sheet.faces.push_back(lanesOf(&others[k]));
  }
  sheet.firstRun.push_back(static_cast<std::int32_t>(sheet.runs.size()));
  sheet.firstFace.push_back(static_cast<std::int32_t>(sheet.faces.size()));
}

/// The faces of a tile, once each, so that those in a run follow each other.
std::vector<FaceId> Clearance::facesOf(std::int32_t tile, const Sheet& sheet) const {
  const MaterialLevel& buckets = sheet.levels.front();
  const Place at = sheet.levels[sheet.tileLevel].placeOf(0, tile);
  const int side = 1 << sheet.tileLevel;
  std::vector<FaceId> faces;
  for (int j = side * at.j; j < std::min(side * (at.j + 1), buckets.rows); ++j) {
    for (int i = side * at.i; i < std::min(side * (at.i + 1), buckets.columns); ++i) {
      for (const FaceId f : sheet.tree->overlapping(buckets.node(i, j))) faces.push_back(f);
    }
  }
  std::sort(faces.begin(), faces.end(), [this](FaceId f, FaceId g) {
    return std::make_pair(shapeOf(f), faces_[f][0]) < std::make_pair(shapeOf(g), faces_[g][0]);
  });
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

/// The steps from the number of the first corner of a face to those of the others.
std::array<std::int32_t, 2> Clearance::shapeOf(FaceId f) const {
  return {faces_[f][1] - faces_[f][0], faces_[f][2] - faces_[f][0]};
}

/// Tells whether four faces are a run.
bool Clearance::isRun(const FaceId* faces) const {
  constexpr double kRounding = 1e-6;  // of single precision
  const Eigen::Matrix2d& inverse = (*inverseRest_)[faces[0]];
  for (int k = 1; k < kLanes; ++k) {
    for (int corner = 0; corner < 3; ++corner) {
      if (faces_[faces[k]][corner] != faces_[faces[0]][corner] + k) return false;
    }
    if (!(*inverseRest_)[faces[k]].isApprox(inverse, kRounding)) return false;
  }
  return true;
}

FaceRun Clearance::runFrom(FaceId first) const {
  FaceRun run{};
  for (int corner = 0; corner < 3; ++corner) run.corners[corner] = faces_[first][corner];
  for (int n = 0; n < 4; ++n) {
    run.inverseRest[n] = static_cast<float>((*inverseRest_)[first](n / 2, n % 2));
  }
  return run;
}

FaceLanes Clearance::lanesOf(const FaceId* faces) const {
  FaceLanes lanes{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const FaceRun face = runFrom(faces[lane]);
    for (int corner = 0; corner < 3; ++corner) lanes.corners[corner][lane] = face.corners[corner];
    for (int n = 0; n < 4; ++n) lanes.inverseRest[n][lane] = face.inverseRest[n];
  }
  return lanes;
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
  MaterialLevel& tiles = sheet.levels[sheet.tileLevel];
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
  for (std::size_t k = sheet.tileLevel + 1; k < sheet.levels.size(); ++k) {
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
  if (place.level == sheet.tileLevel) divideAround(place, sheet);
  return sheet.levels[place.level - 1].partsOf(place, out);
}

/// Brings what lies below a tile and its neighbours up to date: parts of neighbours are proven
/// together.
void Clearance::divideAround(const Place& tile, Sheet& sheet) {
  const MaterialLevel& tiles = sheet.levels[sheet.tileLevel];
  for (int j = std::max(0, tile.j - 1); j < std::min(tile.j + 2, tiles.rows); ++j) {
    for (int i = std::max(0, tile.i - 1); i < std::min(tile.i + 2, tiles.columns); ++i) {
      std::uint8_t& isDivided = sheet.isDivided[tiles.node(i, j)];
      if (isDivided == 0) divide({sheet.tileLevel, i, j}, sheet);
      isDivided = 1;
    }
  }
}

/// Brings the nodes below a tile up to date, the smallest first.
void Clearance::divide(const Place& tile, Sheet& sheet) {
  for (int k = 0; k < sheet.tileLevel; ++k) {
    MaterialLevel& level = sheet.levels[k];
    const int side = 1 << (sheet.tileLevel - k);
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
