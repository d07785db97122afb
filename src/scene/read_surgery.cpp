#include "readers.h"
#include "section.h"

namespace cloth_sim {

namespace {

constexpr Range kSnap{0.05, 0.45, false, false};  // fraction of an edge
constexpr int kMostParticles = 100000000;         // 32 bits number the springs

const Section<Refinement> kRefinementSection{
    "Refinements",
    {Key<Refinement>::required("radius", &Refinement::radius, kPositive),
     {"generations", &Refinement::generations, 0, kMostGenerations},
     {"min_edge", &Refinement::minEdge, kNotNegative}}};

const Section<SurgerySettings> kSurgerySection{
    "`cloth.surgery`",
    {{"snap", &SurgerySettings::snap, kSnap},
     {"min_edge", &SurgerySettings::minEdge, kPositive},
     {"max_particles"},
     {"drop_below", &SurgerySettings::dropBelow, kNotNegative},
     {"clear_strip", &SurgerySettings::clearStrip},
     {"refine_cuts", [](const SceneNode& value, SurgerySettings& surgery) {
        surgery.refineCuts = readRefinement(value);
      }}}};

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

/// Refuses a map unless it has exactly one of two keys.
void expectEither(const SceneNode& node, const std::string& one, const std::string& other) {
  if (!node.has(one) && !node.has(other)) {
    node.refuse("expected either " + one + " or " + other + " (got none)");
  }
  if (node.has(one) && node.has(other)) {
    node.refuse("expected either " + one + " or " + other + " (got both)");
  }
}

const Section<Stroke> kStrokeSection{"`phases.<name>.cut`",
                                     {{"path"},
                                      {"direction"},
                                      {"reach"},
                                      {"blades"},
                                      {"first_layer", &Stroke::firstLayerOnly},
                                      {"half_width", &Stroke::halfWidth, kNotNegative}}};

Stroke readStroke(const SceneNode& node) {
  node.expectKeys(kStrokeSection.keys().names);
  expectEither(node, "path", "blades");
  Stroke stroke = node.has("path") ? readDrawnBlade(node) : readMovedBlade(node);
  kStrokeSection.readKnown(node, stroke);
  const std::string error = validationError(stroke);
  if (!error.empty()) node.refuse(error);
  return stroke;
}

const Section<RefineNear> kRefineNearSection{
    "`phases.<name>.refine`",
    {{"path", [](const SceneNode& value, RefineNear& near) { near.path = readPoints(value, 1); }},
     {"point", [](const SceneNode& value, RefineNear& near) { near.path = {value.vector<3>()}; }},
     {"radius"},
     {"generations"},
     {"min_edge"}}};

RefineNear readRefineNear(const SceneNode& node) {
  node.expectKeys(kRefineNearSection.keys().names);
  expectEither(node, "path", "point");
  RefineNear near;
  kRefineNearSection.readKnown(node, near);
  kRefinementSection.readKnown(node, near.refinement);
  return near;
}

/// Returns the maps of a list, or the one map that stands in its place.
std::vector<SceneNode> oneOrMore(const SceneNode& node) {
  if (node.isMap()) return {node};
  const std::string what = "a map, or a list of maps";
  std::vector<SceneNode> items = node.list(what);
  if (items.empty()) node.expected(what);
  return items;
}

}  // namespace

Refinement readRefinement(const SceneNode& node) { return kRefinementSection.read(node); }

void readSurgery(const SceneNode& node, int particles, SurgerySettings& surgery) {
  kSurgerySection.read(node, surgery);
  node.read("max_particles", surgery.maxParticles, particles, kMostParticles);
}

void readStrokes(const SceneNode& node, std::vector<Stroke>& strokes) {
  for (const SceneNode& item : oneOrMore(node)) strokes.push_back(readStroke(item));
}

void readRefinements(const SceneNode& node, std::vector<RefineNear>& refinements) {
  for (const SceneNode& item : oneOrMore(node)) refinements.push_back(readRefineNear(item));
}

void listSurgeryKeys(std::vector<KeyTable>& tables) {
  tables.push_back(kSurgerySection.keys());
  tables.push_back(kRefinementSection.keys());
  tables.push_back(kStrokeSection.keys());
  tables.push_back(kRefineNearSection.keys());
}

}  // namespace cloth_sim
