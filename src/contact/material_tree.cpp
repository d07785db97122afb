#include "material_tree.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "threads/parallel_for.h"

namespace cloth_sim {
namespace {

/// Cells along the side of a bucket.
constexpr double kCells = 1.0;
/// Round-off of material coordinates, as a fraction of a bucket.
constexpr double kRounding = 1e-9;
/// Pairs of nodes into which a search is divided, at least.
constexpr std::size_t kLeastParts = 64;
constexpr std::int32_t kNodeGrain = 1024;

struct MaterialBox {
  Vec2 low = Vec2::Constant(1e300);
  Vec2 high = Vec2::Constant(-1e300);

  void add(const Vec2& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

MaterialBox materialBox(const TriangleMesh& mesh, FaceId f) {
  MaterialBox box;
  for (const VertexId v : mesh.face(f)) box.add(mesh.material(v));
  return box;
}

Vec2 centre(const TriangleMesh& mesh, FaceId f) {
  const Face& face = mesh.face(f);
  return (mesh.material(face[0]) + mesh.material(face[1]) + mesh.material(face[2])) / 3.0;
}

/// Turns a list of (bucket, face) into faces by bucket, in the order of the list.
void sortByBucket(const std::vector<std::pair<std::int32_t, FaceId>>& entries, std::size_t buckets,
                  std::vector<std::int32_t>& start, std::vector<FaceId>& faces) {
  start.assign(buckets + 1, 0);
  for (const auto& [bucket, face] : entries) ++start[static_cast<std::size_t>(bucket) + 1];
  for (std::size_t k = 0; k < buckets; ++k) start[k + 1] += start[k];
  std::vector<std::int32_t> next = start;
  faces.resize(entries.size());
  for (const auto& [bucket, face] : entries) faces[next[bucket]++] = face;
}

}  // namespace

void MaterialTree::build(const Model& model, std::vector<FaceId> faces) {
  faces_ = std::move(faces);
  levels_.clear();
  if (faces_.empty()) return;
  const ClothPart& cloth = model.cloths[model.clothOf(model.mesh.face(faces_[0])[0])];
  MaterialBox all;
  double area = 0.0;
  for (const FaceId f : faces_) {
    for (const VertexId v : model.mesh.face(f)) all.add(model.mesh.material(v));
    area += model.mesh.restArea(f);
  }
  const double cell = std::sqrt(2.0 * area / static_cast<double>(faces_.size()));
  size_ = kCells *
          (cloth.grid ? Vec2(cloth.grid->spacingU(), cloth.grid->spacingV()) : Vec2(cell, cell));
  constexpr double kMostBuckets = 2048.0;  // along a side
  size_ = size_.cwiseMax((all.high - all.low) / kMostBuckets);
  // Buckets are cells of the grid also where a piece begins within one.
  const Vec2 corner(cloth.materialOffset, 0.0);
  const Vec2 skipped = (all.low - corner).cwiseQuotient(size_) + Vec2::Constant(kRounding);
  origin_ = corner + Vec2(skipped.array().floor()).cwiseProduct(size_);
  const Vec2 extent = all.high - origin_;
  const int columns = std::max(1, static_cast<int>(std::ceil(extent.x() / size_.x() - kRounding)));
  const int rows = std::max(1, static_cast<int>(std::ceil(extent.y() / size_.y() - kRounding)));
  forLevels(columns, rows, [this](int across, int along) { addLevel(across, along); });
  placeFaces(model);
  findContributions(model);
  blockOpenBorders(model);
}

void MaterialTree::addLevel(int columns, int rows) {
  Level& level = levels_.emplace_back();
  level.resize(columns, rows);
  level.before.resize(level.boxes.size());
  level.marks.resize(level.boxes.size());
  level.isLost.resize(level.boxes.size());
}

/// The first and last column and the first and last row of the buckets that a box reaches.
/// \param tolerance  by which the box grows; shrinks, if negative [m].
std::array<int, 4> MaterialTree::bucketsNear(const Vec2& low, const Vec2& high,
                                             double tolerance) const {
  const auto index = [](double at, int count) {
    return std::min(std::max(static_cast<int>(std::floor(at)), 0), count - 1);
  };
  const Vec2 from = (low - origin_ - Vec2::Constant(tolerance)).cwiseQuotient(size_);
  const Vec2 to = (high - origin_ + Vec2::Constant(tolerance)).cwiseQuotient(size_);
  const Level& buckets = levels_.front();
  return {index(from.x(), buckets.columns), index(to.x(), buckets.columns),
          index(from.y(), buckets.rows), index(to.y(), buckets.rows)};
}

void MaterialTree::placeFaces(const Model& model) {
  std::vector<std::pair<std::int32_t, FaceId>> entries;
  overhang_ = 0.0;
  for (const FaceId f : faces_) {
    const Vec2 at = centre(model.mesh, f);
    const std::array<int, 4> bucket = bucketsNear(at, at, 0.0);
    entries.emplace_back(levels_.front().node(bucket[0], bucket[2]), f);
    const Vec2 low = origin_ + size_.cwiseProduct(Vec2(bucket[0], bucket[2]));
    const MaterialBox box = materialBox(model.mesh, f);
    overhang_ =
        std::max({overhang_, (low - box.low).maxCoeff(), (box.high - low - size_).maxCoeff()});
  }
  if (overhang_ < kRounding * size_.minCoeff()) overhang_ = 0.0;
  sortByBucket(entries, levels_.front().boxes.size(), ownedStart_, owned_);
}

/// Lists, for each bucket grown by the overhang, the faces that overlap it. So the parts of the
/// material plane that nodes stand for are convex, contain the faces that nodes own, and the balls
/// of the nodes contain all gradients in them.
void MaterialTree::findContributions(const Model& model) {
  std::vector<std::pair<std::int32_t, FaceId>> entries;
  const double tolerance = overhang_ - kRounding * size_.minCoeff();
  reachStart_.assign(static_cast<std::size_t>(model.mesh.faceCount()) + 1, 0);
  reach_.clear();
  for (const FaceId f : faces_) {
    const MaterialBox box = materialBox(model.mesh, f);
    const std::array<int, 4> near = bucketsNear(box.low, box.high, tolerance);
    for (int j = near[2]; j <= near[3]; ++j) {
      for (int i = near[0]; i <= near[1]; ++i) {
        entries.emplace_back(levels_.front().node(i, j), f);
        reach_.push_back(entries.back().first);
      }
    }
    reachStart_[f + 1] = static_cast<std::int32_t>(reach_.size());
  }
  for (std::size_t k = 1; k < reachStart_.size(); ++k) {
    reachStart_[k] = std::max(reachStart_[k], reachStart_[k - 1]);  // faces of other cloths
  }
  sortByBucket(entries, levels_.front().boxes.size(), gradientStart_, gradients_);
}

/// Blocks the buckets at borders inside the convex hull of the cloth: cuts, tears, and the outline
/// of a cloth that is not a rectangle.
void MaterialTree::blockOpenBorders(const Model& model) {
  isBlocked_.assign(levels_.front().boxes.size(), false);
  const TriangleMesh& mesh = model.mesh;
  const bool isRectangle = model.cloths[model.clothOf(mesh.face(faces_[0])[0])].grid.has_value();
  for (const FaceId f : faces_) {
    const Face& face = mesh.face(f);
    for (int k = 0; k < 3; ++k) {
      const VertexId a = face[k];
      const VertexId b = face[(k + 1) % 3];
      if (isRectangle && mesh.isOriginalBoundary(f, k)) continue;
      if (mesh.facesOnEdge(a, b)[1] != kNone) continue;
      MaterialBox box;
      box.add(mesh.material(a));
      box.add(mesh.material(b));
      const double reach = overhang_ + kRounding * size_.maxCoeff();
      const std::array<int, 4> near = bucketsNear(box.low, box.high, reach);
      for (int j = near[2]; j <= near[3]; ++j) {
        for (int i = near[0]; i <= near[1]; ++i) isBlocked_[levels_.front().node(i, j)] = true;
      }
    }
  }
}

void MaterialTree::refit(const std::vector<QuickBox>& boxes,
                         const std::vector<GradientBall>& gradients) {
  unmark();
  areAllChanged_ = true;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    levels_[k].forgetProofs();
    parallelFor(levels_[k].count(), kNodeGrain, [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t node = first; node < last; ++node) {
        if (k == 0) {
          refitBucket(node, boxes, gradients);
        } else {
          levels_[k].join(levels_[k - 1], node);
        }
      }
    });
  }
}

void MaterialTree::refit(const std::vector<FaceId>& faces, const std::vector<QuickBox>& boxes,
                         const std::vector<GradientBall>& gradients) {
  if (levels_.empty()) return;
  unmark();
  areAllChanged_ = false;
  for (const FaceId f : faces) {
    for (std::int32_t at = reachStart_[f]; at < reachStart_[f + 1]; ++at) {
      markChanged(levels_.front(), reach_[at]);
    }
  }
  for (const std::int32_t bucket : levels_.front().changed) refitBucket(bucket, boxes, gradients);
  exposeLost(levels_.front());
  for (std::size_t above = 1; above < levels_.size(); ++above) {
    const Level& below = levels_[above - 1];
    Level& level = levels_[above];
    const auto nodeAbove = [&](std::int32_t node) {
      return level.node(node % below.columns / 2, node / below.columns / 2);
    };
    for (const std::int32_t node : below.changed) markChanged(level, nodeAbove(node));
    for (const std::int32_t node : level.changed) level.join(below, node);
    for (const std::int32_t node : below.exposed) markExposed(level, nodeAbove(node));
    exposeLost(level);
  }
}

/// Takes the marks of the last refit back.
void MaterialTree::unmark() {
  for (Level& level : levels_) {
    for (const auto* nodes : {&level.changed, &level.exposed}) {
      for (const std::int32_t node : *nodes) level.marks[node] = Mark::kSame;
    }
    for (const std::int32_t square : level.lost) level.isLost[square] = 0;
    level.changed.clear();
    level.exposed.clear();
    level.lost.clear();
  }
}

void MaterialTree::markChanged(Level& level, std::int32_t node) {
  if (level.marks[node] == Mark::kChanged) return;
  level.marks[node] = Mark::kChanged;
  level.before[node] = level.balls[node];
  level.changed.push_back(node);
  level.doubtProofs(node);
}

void MaterialTree::markExposed(Level& level, std::int32_t node) {
  if (level.marks[node] != Mark::kSame) return;
  level.marks[node] = Mark::kExposed;
  level.exposed.push_back(node);
}

/// Marks the nodes of squares that have lost their proof. A pair of nodes may have been ruled out
/// by a square with other nodes in it; then these have changed, not the pair.
void MaterialTree::exposeLost(Level& level) {
  for (const std::int32_t node : level.changed) {
    level.settleDoubts(node, [&](std::int32_t square) {
      level.isLost[square] = 1;
      level.lost.push_back(square);
    });
  }
  for (const std::int32_t square : level.lost) {
    const Place from = level.placeOf(0, square);
    for (int j = from.j; j < std::min(from.j + 2, level.rows); ++j) {
      for (int i = from.i; i < std::min(from.i + 2, level.columns); ++i) {
        markExposed(level, level.node(i, j));
      }
    }
  }
}

void MaterialTree::refitBucket(std::int32_t bucket, const std::vector<QuickBox>& boxes,
                               const std::vector<GradientBall>& gradients) {
  Level& buckets = levels_.front();
  QuickBox box;
  for (const FaceId* f = begin(bucket); f != end(bucket); ++f) box.add(boxes[*f]);
  buckets.boxes[bucket] = box;
  GradientBall ball;
  for (std::int32_t at = gradientStart_[bucket]; at < gradientStart_[bucket + 1]; ++at) {
    ball.add(gradients[gradients_[at]]);
  }
  buckets.balls[bucket] = isBlocked_[bucket] ? GradientBall::unknown() : ball;
}

const QuickBox& MaterialTree::boxAt(const Place& at) const {
  const Level& level = levels_[at.level];
  return level.boxes[level.node(at.i, at.j)];
}

bool MaterialTree::isNew(const Place& at) const {
  const Level& level = levels_[at.level];
  return areAllChanged_ || level.marks[level.node(at.i, at.j)] == Mark::kChanged;
}

/// Tells whether pairs of faces under two nodes of a level may have come near since the last
/// search.
bool MaterialTree::isChanged(const Place& a, const Place& b) const {
  const Level& level = levels_[a.level];
  return level.marks[level.node(a.i, a.j)] != Mark::kSame ||
         level.marks[level.node(b.i, b.j)] != Mark::kSame;
}

/// Tells whether two nodes of a level, which are not ruled out now, were so before the last refit.
bool MaterialTree::wasSmooth(const Place& a, const Place& b) const {
  if (!MaterialLevel::areNeighbours(a, b)) return false;
  const Level& level = levels_[a.level];
  const auto isLost = [&](int i, int j) { return level.isLost[level.node(i, j)] != 0; };
  if (level.anySquareAround(a, b, isLost)) return true;
  if (a.i != b.i && a.j != b.j) return false;  // their rectangle is a square
  return MaterialLevel::isProven(a, b, [&](int i, int j) -> const GradientBall& {
    const int node = level.node(i, j);
    return level.marks[node] == Mark::kChanged ? level.before[node] : level.balls[node];
  });
}

/// Threads take pairs of large nodes; what they find is put together in the order of these.
void MaterialTree::collectOwn(const NearPairs& near) {
  if (levels_.empty()) return;
  const Place root{static_cast<int>(levels_.size()) - 1, 0, 0};
  parts_.assign(1, {root, root, areAllChanged_});
  while (!parts_.empty() && parts_.size() < kLeastParts && parts_.front().a.level > 0) {
    whole_.swap(parts_);
    parts_.clear();
    for (const NodePair& pair : whole_) {
      forOpenChildren(pair, [&](const NodePair& child) { parts_.push_back(child); });
    }
  }
  found_.resize(std::max(found_.size(), parts_.size()));
  std::atomic<std::size_t> all{near.pairs.size()};
  parallelForEach(parts_.size(), [&](std::size_t k) {
    found_[k].clear();
    collectPair(parts_[k], {near.boxes, found_[k], near.enough, &all});
    all += found_[k].size();
  });
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    near.pairs.insert(near.pairs.end(), found_[k].begin(), found_[k].end());
  }
}

/// Calls `visit(pair)` for the pairs of children of a pair of nodes with boxes that meet, unless
/// nothing is to be found under the pair.
template <typename Visit>
void MaterialTree::forOpenChildren(const NodePair& pair, const Visit& visit) const {
  if (!isOpen(pair)) return;
  const bool isNew = pair.isNew || wasSmooth(pair.a, pair.b);
  const bool isSame = pair.isOneNode();
  std::array<Place, 4> partsA, partsB;
  const int countA = children(pair.a, partsA);
  const int countB = children(pair.b, partsB);
  for (int k = 0; k < countA; ++k) {
    const QuickBox& box = boxAt(partsA[k]);
    for (int m = isSame ? k : 0; m < countB; ++m) {
      if (box.meets(boxAt(partsB[m]))) visit(NodePair{partsA[k], partsB[m], isNew});
    }
  }
}

/// Tells whether a pair of nodes may hold pairs of faces that touch and have not been looked at.
bool MaterialTree::isOpen(const NodePair& pair) const {
  return (pair.isNew || isChanged(pair.a, pair.b)) &&
         !levels_[pair.a.level].isSmooth(pair.a, pair.b);
}

/// Adds the pairs of faces under a pair of nodes with boxes that meet.
void MaterialTree::collectPair(const NodePair& pair, const NearPairs& near) const {
  if (near.areEnough()) return;
  if (pair.a.level > 0) {
    return forOpenChildren(pair, [&](const NodePair& child) { collectPair(child, near); });
  }
  if (!isOpen(pair)) return;
  const int first = levels_.front().node(pair.a.i, pair.a.j);
  const int second = levels_.front().node(pair.b.i, pair.b.j);
  for (const FaceId* f = begin(first); f != end(first); ++f) {
    for (const FaceId* g = pair.isOneNode() ? f + 1 : begin(second); g != end(second); ++g) {
      near.add(*f, *g);
    }
  }
}

void MaterialTree::collectBetween(const MaterialTree& a, const MaterialTree& b,
                                  const NearPairs& near) {
  if (a.levels_.empty() || b.levels_.empty()) return;
  collectPairBetween(a, {static_cast<int>(a.levels_.size()) - 1, 0, 0}, b,
                     {static_cast<int>(b.levels_.size()) - 1, 0, 0}, near);
}

void MaterialTree::collectPairBetween(const MaterialTree& treeA, const Place& a,
                                      const MaterialTree& treeB, const Place& b,
                                      const NearPairs& near) {
  if (near.areEnough() || (!treeA.isNew(a) && !treeB.isNew(b))) return;
  if (!treeA.boxAt(a).meets(treeB.boxAt(b))) return;
  if (a.level == 0 && b.level == 0) {
    const int first = treeA.levels_.front().node(a.i, a.j);
    const int second = treeB.levels_.front().node(b.i, b.j);
    for (const FaceId* f = treeA.begin(first); f != treeA.end(first); ++f) {
      for (const FaceId* g = treeB.begin(second); g != treeB.end(second); ++g) {
        near.add(*f, *g);
      }
    }
    return;
  }
  std::array<Place, 4> parts;
  if (a.level >= b.level) {
    const int count = treeA.children(a, parts);
    for (int k = 0; k < count; ++k) collectPairBetween(treeA, parts[k], treeB, b, near);
  } else {
    const int count = treeB.children(b, parts);
    for (int k = 0; k < count; ++k) collectPairBetween(treeA, a, treeB, parts[k], near);
  }
}

}  // namespace cloth_sim
