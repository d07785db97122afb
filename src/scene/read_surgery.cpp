#include "keys.h"
#include "readers.h"

namespace cloth_sim {

namespace {

constexpr Range kSnap{0.05, 0.45, false, false};  // part of an edge
constexpr int kMostParticles = 100000000;         // springs are numbered by 32 bits

/// The keys of a refinement in a map that may have others too.
Refinement readRefinementKeys(const SceneNode& map) {
  Refinement refinement;
  refinement.radius = map.need("radius", kPositive.text()).number(kPositive);
  map.read("generations", refinement.generations, 0, kMostGenerations);
  map.read("min_edge", refinement.minEdge, kNotNegative);
  return refinement;
}

std::vector<Vec3> readPoints(const SceneNode& node, std::size_t least) {
  const std::string what = "a list of at least " + std::to_string(least) + " point" +
                           (least > 1 ? "s" : "") + " [x, y, z]";
  std::vector<Vec3> points;
  for (const SceneNode& item : node.list(what)) points.push_back(item.vector<3>());
  if (points.size() < least) node.expected(what);
  return points;
}

std::vector<Blade> readBlades(const SceneNode& node) {
  const std::string what = "a list of at least 2 blades, [heel, tip] each";
  const std::string ends = "the ends of a blade, [[x, y, z], [x, y, z]]";
  std::vector<Blade> poses;
  for (const SceneNode& item : node.list(what)) {
    const std::vector<SceneNode> points = item.list(ends);
    if (points.size() != 2) item.expected(ends);
    poses.push_back({points[0].vector<3>(), points[1].vector<3>()});
  }
  if (poses.size() < 2) node.expected(what);
  return poses;
}

Stroke readDrawnBlade(const SceneNode& node) {
  const std::vector<Vec3> path = readPoints(node.need("path", "a list of points"), 2);
  const SceneNode direction = node.need("direction", "[x, y, z]");
  if (direction.vector<3>().isZero(0.0)) direction.refuse("expected a direction other than zero");
  double reach = kDefaultReach;
  node.read("reach", reach, kPositive);
  return strokeAlong(path, direction.vector<3>(), reach);
}

Stroke readMovedBlade(const SceneNode& node) {
  for (const char* key : {"direction", "reach"}) {
    if (const auto other = node.find(key)) {
      other->refuse(std::string("expected no ") + key + " beside blades");
    }
  }
  Stroke stroke;
  stroke.poses = readBlades(node.need("blades", "a list of blades"));
  return stroke;
}

/// Refuses a map that has not exactly one of two keys.
void expectEither(const SceneNode& node, const std::string& one, const std::string& other) {
  if (!node.has(one) && !node.has(other)) {
    node.refuse("expected either " + one + " or " + other + " (got none)");
  }
  if (node.has(one) && node.has(other)) {
    node.refuse("expected either " + one + " or " + other + " (got both)");
  }
}

Stroke readStroke(const SceneNode& node) {
  node.expectKeys(keys::kStroke);
  expectEither(node, "path", "blades");
  Stroke stroke = node.has("path") ? readDrawnBlade(node) : readMovedBlade(node);
  node.read("first_layer", stroke.firstLayerOnly);
  node.read("half_width", stroke.halfWidth, kNotNegative);
  const std::string defect = validationError(stroke);
  if (!defect.empty()) node.refuse(defect);
  return stroke;
}

RefineNear readRefineNear(const SceneNode& node) {
  node.expectKeys(keys::kRefine);
  expectEither(node, "path", "point");
  RefineNear refine;
  if (const auto path = node.find("path")) refine.path = readPoints(*path, 1);
  if (const auto point = node.find("point")) refine.path = {point->vector<3>()};
  refine.refinement = readRefinementKeys(node);
  return refine;
}

/// The maps of a list, or the one that stands there without a list.
std::vector<SceneNode> oneOrMore(const SceneNode& node) {
  if (node.isMap()) return {node};
  const std::string what = "a map, or a list of maps";
  std::vector<SceneNode> items = node.list(what);
  if (items.empty()) node.expected(what);
  return items;
}

}  // namespace

Refinement readRefinement(const SceneNode& node) {
  node.expectKeys(keys::kRefinement);
  return readRefinementKeys(node);
}

void readSurgery(const SceneNode& node, int particles, SurgerySettings& surgery) {
  node.expectKeys(keys::kSurgery);
  node.read("snap", surgery.snap, kSnap);
  node.read("min_edge", surgery.minEdge, kPositive);
  node.read("max_particles", surgery.maxParticles, particles, kMostParticles);
  node.read("drop_below", surgery.dropBelow, kNotNegative);
  node.read("clear_strip", surgery.clearStrip);
  if (const auto refine = node.find("refine_cuts")) surgery.refineCuts = readRefinement(*refine);
}

void readStrokes(const SceneNode& node, std::vector<Stroke>& strokes) {
  for (const SceneNode& item : oneOrMore(node)) strokes.push_back(readStroke(item));
}

void readRefinements(const SceneNode& node, std::vector<RefineNear>& refinements) {
  for (const SceneNode& item : oneOrMore(node)) refinements.push_back(readRefineNear(item));
}

}  // namespace cloth_sim
