#include "readers.h"
#include "section.h"
#include "surface_reader.h"

namespace cloth_sim {
namespace {

/// The keys besides `type` and the dimensions of the shape.
const Section<Obstacle> kObstacleSection{
    "`obstacles.<name>`",
    {{"position"},
     {"rpy"},
     {"orientation"},
     {"velocity", &Obstacle::velocity},
     {"angular_velocity", &Obstacle::angularVelocity},
     {"friction", &Obstacle::friction, kNotNegative},
     {"tangential_decay", &Obstacle::tangentialDecay, kNotNegative}}};

void readDimension(const SceneNode& map, const char* key, double& length) {
  length = map.need(key, kPositive.text()).number(kPositive);
}

void readDimension(const SceneNode& map, const char* key, Vec3& size) {
  size = map.need(key, "[x, y, z]").vector<3>(kPositive);
}

void readDimension(const SceneNode& map, const char* key, bool& isOn) { map.read(key, isOn); }

/// Reads one scale for all axes, or one for each.
void readDimension(const SceneNode& map, const char* key, std::optional<Vec3>& scale) {
  const std::optional<SceneNode> value = map.find(key);
  if (!value) return;
  scale = value->isList() ? value->vector<3>() : Vec3(Vec3::Constant(value->number(kPositive)));
  if (!(scale->cwiseAbs().minCoeff() > 0.0)) value->expected("numbers other than 0");
}

void readDimension(const SceneNode& map, const char* key, SurfaceFile& file) {
  const std::string what = "the name of an STL, OBJ or DAE file";
  const SceneNode value = map.need(key, what);
  const std::string name = value.word(what);
  if (name.empty()) value.expected(what);
  std::optional<Vec3> scale;
  readDimension(map, "scale", scale);
  file = readSurface(besideScene(value, name), name, scale.value_or(Vec3::Ones()));
}

/// Returns the default shape of the type that the map names.
Shape readType(const SceneNode& map) {
  std::vector<std::pair<std::string, Shape>> types;
  std::vector<std::string> names;
  for (const Shape& shape : allShapes()) {
    for (const std::string& name : typeNames(shape)) {
      types.emplace_back(name, shape);
      names.push_back(name);
    }
  }
  if (!map.isMap()) map.expected("a map with a type");
  return map.need("type", "one of " + joinNames(names)).choice(types);
}

/// The keys of an obstacle of this shape.
std::vector<std::string> keysOf(const Shape& shape) {
  std::vector<std::string> names{"type"};
  const auto add = [&names](const char* key, const auto& /*dimension*/) { names.push_back(key); };
  std::visit([&add](const auto& known) { forEachKey(known, add); }, shape);
  names.insert(names.end(), kObstacleSection.keys().names.begin(),
               kObstacleSection.keys().names.end());
  return names;
}

Shape readShape(const SceneNode& map) {
  Shape shape = readType(map);
  map.expectKeys(keysOf(shape));
  const auto read = [&map](const char* key, auto& length) { readDimension(map, key, length); };
  std::visit([&read](auto& known) { forEachKey(known, read); }, shape);
  return shape;
}

Obstacle readObstacle(const SceneNode& map) {
  Obstacle obstacle;
  obstacle.name = map.key();
  obstacle.shape = readShape(map);
  readPose(map, obstacle.pose);
  kObstacleSection.readKnown(map, obstacle);
  return obstacle;
}

}  // namespace

void readObstacles(const SceneNode& node, std::vector<Obstacle>& obstacles) {
  for (const SceneNode& entry : node.entries()) obstacles.push_back(readObstacle(entry));
}

void listObstacleKeys(std::vector<KeyTable>& tables) {
  KeyTable table{kObstacleSection.keys().heading, {}};
  for (const Shape& shape : allShapes()) {
    const std::vector<std::string> names = keysOf(shape);
    table.names.insert(table.names.end(), names.begin(), names.end());
  }
  tables.push_back(table);
}

}  // namespace cloth_sim
