#include "keys.h"
#include "readers.h"

namespace cloth_sim {
namespace {

void readDimension(const SceneNode& map, const char* key, double& length) {
  length = map.need(key, kPositive.text()).number(kPositive);
}

void readDimension(const SceneNode& map, const char* key, Vec3& size) {
  size = map.need(key, "[x, y, z]").vector<3>(kPositive);
}

/// The default shape of the type that the map names.
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

Shape readShape(const SceneNode& map) {
  Shape shape = readType(map);
  map.expectKeys(obstacleKeys(shape));
  const auto read = [&map](const char* key, auto& dimension) {
    readDimension(map, key, dimension);
  };
  std::visit([&read](auto& known) { forEachKey(known, read); }, shape);
  return shape;
}

Obstacle readObstacle(const SceneNode& map) {
  Obstacle obstacle;
  obstacle.name = map.key();
  obstacle.shape = readShape(map);
  readPose(map, obstacle.pose);
  map.read("velocity", obstacle.velocity);
  map.read("friction", obstacle.friction, kNotNegative);
  map.read("tangential_decay", obstacle.tangentialDecay, kNotNegative);
  return obstacle;
}

}  // namespace

std::vector<std::string> obstacleKeys(const Shape& shape) {
  std::vector<std::string> names{"type"};
  const auto add = [&names](const char* key, const auto& /*dimension*/) { names.push_back(key); };
  std::visit([&add](const auto& known) { forEachKey(known, add); }, shape);
  names.insert(names.end(), keys::kObstacle.begin(), keys::kObstacle.end());
  return names;
}

void readObstacles(const SceneNode& node, std::vector<Obstacle>& obstacles) {
  for (const SceneNode& entry : node.entries()) obstacles.push_back(readObstacle(entry));
}

}  // namespace cloth_sim
