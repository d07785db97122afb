#include "cloth_sim/validation.h"
#include "readers.h"
#include "section.h"

namespace cloth_sim {

namespace {

const Section<Pose> kPoseSection{"Poses",
                                 {{"position", &Pose::position}, {"rpy"}, {"orientation"}}};

const Section<Wind> kWindSection{"`wind`",
                                 {{"velocity", &Wind::velocity},
                                  {"density", &Wind::density, kNotNegative},
                                  {"drag_coefficient", &Wind::dragCoefficient, kNotNegative}}};

const KeyTable& ratioKeys() {
  static const KeyTable table = [] {
    KeyTable keys{"`tearing.ratio`", {}};
    for (int kind = 0; kind < kSpringKinds; ++kind) {
      keys.names.emplace_back(toString(static_cast<SpringKind>(kind)));
    }
    return keys;
  }();
  return table;
}

Quat quaternion(const SceneNode& node) {
  const Eigen::Vector4d xyzw = node.vector<4>();
  const Quat orientation(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  if (!isUnit(orientation)) {
    node.refuse("expected a unit quaternion [x, y, z, w] (got one of norm " +
                shortNumber(xyzw.norm()) + ")");
  }
  return orientation.normalized();
}

/// Rotation by roll, pitch and yaw [rad] about the fixed axes x, y and z (REP 103).
Quat fromRollPitchYaw(const Vec3& rpy) {
  return Quat(Eigen::AngleAxisd(rpy.z(), Vec3::UnitZ()) *
              Eigen::AngleAxisd(rpy.y(), Vec3::UnitY()) *
              Eigen::AngleAxisd(rpy.x(), Vec3::UnitX()));
}

void checkOnCloth(const SceneNode& node, const Vec2& point, const ClothSpec& cloth) {
  const double cellU = cloth.mesh ? 0.05 * cloth.width : cloth.width / (cloth.columns - 1);
  const double cellV = cloth.mesh ? 0.05 * cloth.height : cloth.height / (cloth.rows - 1);
  const bool inside = point.x() >= -cellU && point.x() <= cloth.width + cellU &&
                      point.y() >= -cellV && point.y() <= cloth.height + cellV;
  if (inside) return;
  node.refuse("expected a point [u, v] of the cloth, u from 0 to " + shortNumber(cloth.width) +
              " and v from 0 to " + shortNumber(cloth.height) + " (got [" + shortNumber(point.x()) +
              ", " + shortNumber(point.y()) + "])");
}

}  // namespace

std::optional<Quat> readOrientation(const SceneNode& map) {
  const std::optional<SceneNode> rpy = map.find("rpy");
  const std::optional<SceneNode> orientation = map.find("orientation");
  if (rpy && orientation) orientation->refuse("expected either rpy or orientation (got both)");
  if (rpy) return fromRollPitchYaw(rpy->vector<3>());
  if (orientation) return quaternion(*orientation);
  return std::nullopt;
}

std::string besideScene(const SceneNode& node, const std::string& file) {
  const std::size_t slash = node.file().find_last_of('/');
  if (file.front() == '/' || slash == std::string::npos) return file;
  return node.file().substr(0, slash + 1) + file;
}

void readPose(const SceneNode& map, Pose& pose) {
  kPoseSection.readKnown(map, pose);
  if (const std::optional<Quat> orientation = readOrientation(map)) pose.orientation = *orientation;
}

void readPoseMap(const SceneNode& map, Pose& pose) {
  map.expectKeys(kPoseSection.keys().names);
  readPose(map, pose);
}

PinSpec readParticle(const SceneNode& node, const ClothSpec& cloth) {
  if (cloth.mesh) node.refuse("a cloth from an OBJ file has no columns and rows");
  const std::vector<SceneNode> indices = node.exactly(2, kNotNegative);
  return {static_cast<int>(indices[0].integer(0, cloth.columns - 1)),
          static_cast<int>(indices[1].integer(0, cloth.rows - 1))};
}

std::size_t readClothName(const SceneNode& map, const std::vector<ClothSpec>& cloths) {
  const auto name = map.find("cloth");
  if (!name) return 0;
  std::vector<std::pair<std::string, std::size_t>> known;
  for (std::size_t k = 0; k < cloths.size(); ++k) known.emplace_back(cloths[k].name, k);
  return name->choice(known);
}

MaterialPath readPath(const SceneNode& node, const std::vector<ClothSpec>& cloths,
                      std::size_t cloth) {
  const std::string what = "a list of at least 2 points [u, v]";
  MaterialPath path;
  for (const SceneNode& item : node.list(what)) {
    const Vec2 point = item.vector<2>();
    checkOnCloth(item, point, cloths[cloth]);
    if (!path.empty() && point == path.back()) {
      item.refuse("expected a point other than the one before it");
    }
    path.push_back(point);
  }
  if (path.size() < 2) node.expected(what);
  const Vec2 offset(materialOffsets(cloths)[cloth], 0.0);
  for (Vec2& point : path) point += offset;
  return path;
}

TearRatios readRatios(const SceneNode& node) {
  const double never = std::numeric_limits<double>::infinity();
  const Range range{1.0, never, true, true};
  TearRatios ratios = infiniteRatios();
  if (node.isMap()) {
    const std::vector<std::string>& kinds = ratioKeys().names;
    node.expectKeys(kinds);
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
      node.read(kinds[kind], ratios[kind], range);
    }
  } else {
    ratios.fill(node.number(range));
  }
  return ratios;
}

Wind readWind(const SceneNode& node) { return kWindSection.read(node); }

void listCommonKeys(std::vector<KeyTable>& tables) {
  tables.push_back(kWindSection.keys());
  tables.push_back(kPoseSection.keys());
  tables.push_back(ratioKeys());
}

}  // namespace cloth_sim
