#include <algorithm>
#include <set>
#include <stdexcept>

#include "cloth_sim/scene/resolution.h"
#include "obj_mesh.h"
#include "readers.h"
#include "section.h"

namespace cloth_sim {

namespace {

constexpr Range kSideLength{1e-3, 1e3, false, false};  // [m]

void readGrid(const SceneNode& node, ClothSpec& cloth) {
  if (const auto size = node.find("size")) {
    const Vec2 lengths = size->vector<2>(kSideLength);
    cloth.width = lengths.x();
    cloth.height = lengths.y();
  }
  if (const auto diagonals = node.find("diagonals")) {
    cloth.diagonals = diagonals->choice<Diagonals>(
        {{"one_way", Diagonals::kOneWay}, {"alternating", Diagonals::kAlternating}});
  }
  const auto particles = node.find("particles");
  if (!particles) return;
  const std::vector<SceneNode> sides = particles->exactly(2, kAnyNumber);
  cloth.columns = static_cast<int>(sides[0].integer(kFewestOnSide, kMostOnSide));
  cloth.rows = static_cast<int>(sides[1].integer(kFewestOnSide, kMostOnSide));
  if (cloth.columns * cloth.rows > kMostInGrids) {
    particles->refuse("expected at most " + std::to_string(kMostInGrids) +
                      " particles in all (got " + std::to_string(cloth.columns * cloth.rows) + ")");
  }
}

void readMesh(const SceneNode& node, ClothSpec& cloth) {
  const auto obj = node.find("obj");
  for (const char* key : {"scale", "uv_scale"}) {
    const auto value = node.find(key);
    if (value && !obj) value->refuse("expected only beside obj");
  }
  if (!obj) return;
  for (const char* key : {"size", "particles", "diagonals"}) {
    if (const auto value = node.find(key)) value->refuse("not beside obj, which says it");
  }
  ObjUnits units;
  node.read("scale", units.scale, kPositive);
  node.read("uv_scale", units.uvScale, kPositive);
  const std::string file = obj->word("the name of an OBJ file");
  if (file.empty()) obj->expected("the name of an OBJ file");
  cloth.mesh = std::make_shared<ClothMesh>(readObj(besideScene(node, file), units));
  Vec2 extent = Vec2::Zero();
  for (const Vec2& uv : cloth.mesh->material) extent = extent.cwiseMax(uv);
  cloth.width = extent.x();
  cloth.height = extent.y();
}

void readName(const SceneNode& node, ClothSpec& cloth) {
  cloth.name = node.word("a name");
  const std::string error = nameError(cloth.name);
  if (!error.empty()) node.refuse(error);
}

void readRandomOffset(const SceneNode& node, ClothSpec& cloth) {
  cloth.randomOffset =
      node.isList() ? node.vector<3>(kNotNegative) : Vec3::Constant(node.number(kNotNegative));
}

Fabric preset(const SceneNode& node) {
  const std::string what = "one of " + joinNames(fabricPresetNames());
  try {
    return fabricPreset(node.word(what));
  } catch (const std::invalid_argument&) {
    node.expected(what);
  }
}

const KeyTable kTearEnergyKeys{"`cloth.fabric.tear_energy`", {"warp", "weft", "bias"}};

/// Reads one energy for all directions, or a map.
TearEnergy readTearEnergy(const SceneNode& node) {
  if (!node.isMap()) {
    const double all = node.number(kPositive);
    return TearEnergy::of(all, all);
  }
  node.expectKeys(kTearEnergyKeys.names);
  TearEnergy energy = TearEnergy::of(node.need("warp", kPositive.text()).number(kPositive),
                                     node.need("weft", kPositive.text()).number(kPositive));
  node.read("bias", energy.bias, kPositive);
  return energy;
}

const Section<Fabric> kFabricSection{
    "`cloth.fabric`",
    {{"preset"},
     {"areal_density", &Fabric::arealDensity, kPositive},
     {"tensile_warp", &Fabric::tensileWarp, kPositive},
     {"tensile_weft", &Fabric::tensileWeft, kPositive},
     {"shear", &Fabric::shear, kNotNegative},
     {"bending", &Fabric::bending, kNotNegative},
     {"bending_hysteresis", &Fabric::bendingHysteresis, kNotNegative},
     {"damping", &Fabric::damping, kNotNegative},
     {"bending_damping", &Fabric::bendingDamping, kNotNegative},
     {"friction", &Fabric::friction, kNotNegative},
     {"thickness", &Fabric::thickness, kNotNegative},
     {"tear_energy",
      [](const SceneNode& value, Fabric& fabric) { fabric.tearEnergy = readTearEnergy(value); }}}};

Fabric readFabric(const SceneNode& node) {
  if (node.isScalar()) return preset(node);
  node.expectKeys(kFabricSection.keys().names);
  const auto name = node.find("preset");
  Fabric fabric = name ? preset(*name) : fabricPreset("cotton");
  kFabricSection.readKnown(node, fabric);
  const bool replacesValues = node.entries().size() > (name ? 1U : 0U);
  if (replacesValues) {
    fabric.source = "the scene, over the preset " + fabric.name + ": " + fabric.source;
    fabric.name = "custom";
  }
  return fabric;
}

/// Reads the constant of one kind of spring.
Key<RawSprings>::ReadValue rawConstant(SpringKind kind, const Range& range) {
  return [kind, range](const SceneNode& value, RawSprings& raw) {
    raw.constant[static_cast<std::size_t>(kind)] = value.number(range);
  };
}

const Section<RawSprings> kRawSpringsSection{
    "`cloth.raw_springs`",
    {Key<RawSprings>::required("structural", kPositive.text(),
                               rawConstant(SpringKind::kStructural, kPositive)),
     {"shear", rawConstant(SpringKind::kShear, kNotNegative)},
     {"bend", rawConstant(SpringKind::kBend, kNotNegative)},
     {"per_stretch", &RawSprings::perStretch},
     {"dashpot", &RawSprings::dashpot, kNotNegative}}};

/// Selects the kinds of springs, and the bending energy instead of bend springs. By default a cloth
/// has the kinds that have a stiffness.
void selectSprings(const SceneNode& node, ClothSpec& cloth) {
  if (cloth.raw) {
    cloth.springs.shear = cloth.raw->constant[1] > 0.0;
    cloth.springs.bend = cloth.raw->constant[2] > 0.0;
  } else {
    cloth.springs.bend = cloth.fabric.bending > 0.0;
  }
  node.read("shear", cloth.springs.shear);
  if (const auto bending = node.find("bending")) {
    enum class Bending { kNone, kSprings, kPlate };
    const auto chosen = bending->choice<Bending>(
        {{"none", Bending::kNone}, {"springs", Bending::kSprings}, {"plate", Bending::kPlate}},
        {{"hinge", Bending::kPlate}});
    cloth.springs.bend = chosen == Bending::kSprings;
    cloth.plate = chosen == Bending::kPlate && cloth.fabric.bending > 0.0;
  }
}

void addRange(int firstColumn, int lastColumn, int firstRow, int lastRow,
              std::vector<PinSpec>& pins) {
  for (int row = firstRow; row <= lastRow; ++row) {
    for (int column = firstColumn; column <= lastColumn; ++column) pins.push_back({column, row});
  }
}

/// Adds the pins of a name, which is a side or a corner of a grid, or of a number, which is a
/// vertex of an OBJ file.
void addNamedPins(const SceneNode& node, const ClothSpec& cloth, std::vector<PinSpec>& pins) {
  if (cloth.mesh) {
    const auto count = static_cast<std::int64_t>(cloth.mesh->positions.size());
    PinSpec pin;
    pin.vertex = static_cast<VertexId>(node.integer(1, count) - 1);
    pins.push_back(pin);
    return;
  }
  struct Part {
    int firstColumn, lastColumn, firstRow, lastRow;
  };
  const int c = cloth.columns - 1;
  const int r = cloth.rows - 1;
  const Part part = node.choice<Part>({{"first_row", {0, c, 0, 0}},
                                       {"last_row", {0, c, r, r}},
                                       {"first_column", {0, 0, 0, r}},
                                       {"last_column", {c, c, 0, r}},
                                       {"corner_00", {0, 0, 0, 0}},
                                       {"corner_10", {c, c, 0, 0}},
                                       {"corner_01", {0, 0, r, r}},
                                       {"corner_11", {c, c, r, r}}});
  addRange(part.firstColumn, part.lastColumn, part.firstRow, part.lastRow, pins);
}

void readPins(const SceneNode& node, ClothSpec& cloth) {
  for (const SceneNode& item : node.list("a list of particles [column, row] or names")) {
    if (item.isScalar()) {
      addNamedPins(item, cloth, cloth.pins);
    } else {
      cloth.pins.push_back(readParticle(item, cloth));
    }
  }
}

int particlesOf(const ClothSpec& cloth) {
  return cloth.mesh ? static_cast<int>(cloth.mesh->positions.size()) : cloth.columns * cloth.rows;
}

/// Keys that are read by hand depend on each other: what a mesh or a fabric gives.
const Section<ClothSpec> kClothSection{
    "`cloth`",
    {{"name", readName},
     {"obj"},
     {"scale"},
     {"uv_scale"},
     {"size"},
     {"particles"},
     {"diagonals"},
     {"pose", [](const SceneNode& value, ClothSpec& cloth) { readPoseMap(value, cloth.pose); }},
     {"random_offset", readRandomOffset},
     {"velocity", &ClothSpec::velocity},
     {"fabric", [](const SceneNode& value, ClothSpec& cloth) { cloth.fabric = readFabric(value); }},
     {"thickness"},
     {"raw_springs",
      [](const SceneNode& value, ClothSpec& cloth) { cloth.raw = kRawSpringsSection.read(value); }},
     {"particle_mass", &ClothSpec::particleMass, kPositive},
     {"shear"},
     {"bending"},
     {"pins"},
     {"surgery"}}};

void readCloth(const SceneNode& node, ClothSpec& cloth) {
  node.expectKeys(kClothSection.keys().names);
  cloth.fabric = fabricPreset("cotton");
  readGrid(node, cloth);
  readMesh(node, cloth);
  kClothSection.readKnown(node, cloth);
  node.read("thickness", cloth.fabric.thickness, kPositive);
  selectSprings(node, cloth);
  if (const auto pins = node.find("pins")) readPins(*pins, cloth);
}

void checkNames(const std::vector<SceneNode>& nodes, const std::vector<ClothSpec>& cloths) {
  if (nodes.size() == 1) return;
  std::set<std::string> names;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (!nodes[k].has("name")) nodes[k].missing("name", "one, as there are several cloths");
    if (!names.insert(cloths[k].name).second) {
      nodes[k].need("name", "a name").refuse("expected a name that no other cloth has");
    }
  }
}

/// Refuses cloths that cannot be one model together.
void checkTogether(const std::vector<SceneNode>& nodes, const std::vector<ClothSpec>& cloths) {
  std::int64_t particles = 0;
  bool plate = false;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    particles += particlesOf(cloths[k]);
    plate = plate || cloths[k].plate;
    if (particles > kMostInGrids && nodes.size() > 1) {
      nodes[k].refuse("expected at most " + std::to_string(kMostInGrids) +
                      " particles in all cloths (got " + std::to_string(particles) +
                      " up to this one)");
    }
  }
  for (std::size_t k = 1; plate && k < nodes.size(); ++k) {
    const double first = cloths[0].fabric.bendRetardation();
    const double here = cloths[k].fabric.bendRetardation();
    if (here == first) continue;
    nodes[k].refuse("expected fabric.damping and fabric.bending_damping of " + shortNumber(first) +
                    " in sum, as cloth '" + cloths[0].name +
                    "' has: with bending: plate all cloths have the same (got " +
                    shortNumber(here) + ")");
  }
}

/// Reads the surgery settings of all cloths, which at most one of them gives.
void readSurgeryOf(const std::vector<SceneNode>& nodes, Scene& scene) {
  int particles = 0;
  for (const ClothSpec& cloth : scene.cloths) particles += particlesOf(cloth);
  scene.surgery.maxParticles = std::max(scene.surgery.maxParticles, particles);
  std::string said;
  for (const SceneNode& node : nodes) {
    const auto surgery = node.find("surgery");
    if (!surgery) continue;
    if (!said.empty()) surgery->refuse("expected it once for all cloths (" + said + " has it)");
    said = surgery->path();
    readSurgery(*surgery, particles, scene.surgery);
  }
}

}  // namespace

std::vector<SceneNode> clothNodes(const SceneNode& node) {
  if (!node.isList()) return {node};
  const std::string what = "a map, or a list of maps with a name each";
  std::vector<SceneNode> nodes = node.list(what);
  if (nodes.empty()) node.expected(what);
  return nodes;
}

void readCloths(const SceneNode& node, Scene& scene) {
  const std::vector<SceneNode> nodes = clothNodes(node);
  scene.cloths.assign(nodes.size(), ClothSpec());
  for (std::size_t k = 0; k < nodes.size(); ++k) readCloth(nodes[k], scene.cloths[k]);
  checkNames(nodes, scene.cloths);
  checkTogether(nodes, scene.cloths);
  readSurgeryOf(nodes, scene);
}

void listClothKeys(std::vector<KeyTable>& tables) {
  tables.push_back(kClothSection.keys());
  tables.push_back(kFabricSection.keys());
  tables.push_back(kTearEnergyKeys);
  tables.push_back(kRawSpringsSection.keys());
}

}  // namespace cloth_sim
