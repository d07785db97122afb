#include "reality_bending.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "cloth_sim/sim/simulation.h"
#include "reality_cloth.h"
#include "reality_elastica.h"

namespace cloth_sim {
namespace {

constexpr double kChord = 41.5 * M_PI / 180.0;  ///< of ASTM D1388 [rad]
// Of all strips: their weight strains them by less than 1e-3.
constexpr double kStripTensile = 500.0;     ///< [N/m]
constexpr double kStripShear = 50.0;        ///< [N/m]
constexpr double kFoldStepLength = 0.5e-3;  ///< [s]

Fabric stripFabric(const BendingFabric& fabric) {
  return plainFabric(fabric.density, fabric.bending, kStripTensile, kStripShear);
}

/// Chord of an overhang at rest [rad].
double simulatedChord(const BendingFabric& fabric, int cells, double overhang) {
  // The clamp begins half a cell behind the last column that is held (docs/model.md).
  const double spacing = overhang / (cells + 0.5);
  HeldCloth cloth(stripOf(stripFabric(fabric), cells + 1, 2, spacing));
  const Grid grid = *cloth.model().cloths[0].grid;
  for (const int column : {0, 1}) {
    for (const int row : {0, 1}) cloth.hold(grid.vertex(column, row));
  }
  cloth.controls.drag = 2.0 * std::sqrt(kRealityGravity / overhang);
  if (!cloth.settle(1e-4 * std::sqrt(kRealityGravity * overhang), 20.0)) {
    throw std::runtime_error("cantilever of " + fabric.name + ": did not come to rest");
  }
  const Vec3 edge = cloth.state.x[grid.vertex(1, 0)] - Vec3(0.5 * spacing, 0.0, 0.0);
  const Vec3 chord = cloth.state.x[grid.vertex(cells + 1, 0)] - edge;
  return std::atan2(-chord.z(), chord.x());
}

/// Where a strip that is folded back on itself begins: level, over half a circle, and level again.
Vec3 foldedAt(double s, double below, double radius) {
  const double turn = (s - below) / radius;
  if (turn < 0.0) return Vec3(s, 0.0, 0.0);
  if (turn > M_PI) return Vec3(below - (turn - M_PI) * radius, 0.0, 2.0 * radius);
  return Vec3(below + radius * std::sin(turn), 0.0, radius * (1.0 - std::cos(turn)));
}

/// A folded strip, two particles across.
ClothSpec foldedStrip(const Fabric& fabric, double unit, double spacing) {
  constexpr double kBelow = 5.0, kAll = 14.0, kRadius = 0.5;  // over the elasto-gravity length
  const int cells = static_cast<int>(kAll * unit / spacing);
  auto mesh = std::make_shared<ClothMesh>();
  for (int column = 0; column <= cells; ++column) {
    for (int row = 0; row < 2; ++row) {
      mesh->material.emplace_back(column * spacing, row * spacing);
      mesh->positions.push_back(foldedAt(column * spacing, kBelow * unit, kRadius * unit) +
                                Vec3(0.0, row * spacing, 0.0));
    }
    if (column == cells) break;
    const VertexId v = 2 * column;
    mesh->faces.push_back({v, v + 2, v + 3});
    mesh->faces.push_back({v, v + 3, v + 1});
  }
  ClothSpec spec = stripOf(fabric, cells, 2, spacing);
  spec.mesh = mesh;
  for (VertexId v = 0; v < 4; ++v) spec.pins.push_back({0, 0, v});
  return spec;
}

/// A plane without friction, its normal turned from z about x.
/// \param roll  [rad]
/// \param y     of a point of it [m]
Obstacle smoothPlane(const std::string& name, double roll, double y) {
  Obstacle plane;
  plane.name = name;
  plane.shape = PlaneShape();
  plane.pose.position.y() = y;
  plane.pose.orientation = Quat(Eigen::AngleAxisd(roll, Vec3::UnitX()));
  plane.friction = 0.0;
  return plane;
}

}  // namespace

const std::vector<BendingFabric>& bendingFabrics() {
  // Bending: the first number of "bending" in the files of the authors' data (along warp, at the
  // least curvature). The names are those of the files.
  static const std::string wang = "Wang et al. 2011";
  static const std::vector<BendingFabric> all = {
      {"ivory-rib-knit", 46.237591e-6, 0.276, wang},
      {"pink-ribbon-brown", 117.070122e-6, 0.228, wang},
      {"white-dots-on-blk", 51.713814e-6, 0.128, wang},
      {"navy-sparkle-sweat", 59.469658e-6, 0.224, wang},
      {"camel-ponte-roma", 36.348366e-6, 0.284, wang},
      {"gray-interlock", 23.191698e-6, 0.187, wang},
      {"11oz-black-denim", 64.196457e-6, 0.324, wang},
      {"white-swim-solid", 60.237942e-6, 0.204, wang},
      {"tango-red-jet-set", 14.293814e-6, 0.113, wang},
      {"royal-target", 125.409805e-6, 0.220, wang},
      {"preset cotton", 5e-6, 0.1036, "src/cloth/fabric.cpp"},
      {"preset silk", 3e-6, 0.083, "src/cloth/fabric.cpp"},
      {"limp", 1e-6, 0.1, "chosen"},
      {"stiff", 200e-6, 0.15, "chosen"}};
  return all;
}

double simulatedOverhang(const BendingFabric& fabric, double spacing) {
  const double guess = 2.0 * elastoGravityLength(fabric.bending, fabric.density);
  const int cells = std::max(4, static_cast<int>(std::lround(guess / spacing)));
  double low = 0.9 * guess, high = 1.1 * guess;
  double below = simulatedChord(fabric, cells, low) - kChord;
  double above = simulatedChord(fabric, cells, high) - kChord;
  double middle = guess;
  for (int k = 0; k < 3; ++k) {
    middle = low - below * (high - low) / (above - below);
    const double value = simulatedChord(fabric, cells, middle) - kChord;
    (value < 0.0 ? low : high) = middle;
    (value < 0.0 ? below : above) = value;
  }
  return middle;
}

double simulatedFoldHeight(const BendingFabric& fabric, double spacing) {
  const double unit = elastoGravityLength(fabric.bending, fabric.density);
  Scene scene;
  scene.cloths[0] = foldedStrip(stripFabric(fabric), unit, spacing);
  // Walls beside the strip keep it in its plane: it would fall over.
  scene.obstacles = {smoothPlane("table", 0.0, 0.0), smoothPlane("left", 0.5 * M_PI, spacing),
                     smoothPlane("right", -0.5 * M_PI, 0.0)};
  scene.gravity = Vec3(0.0, 0.0, -kRealityGravity);
  scene.drag = 2.0 * std::sqrt(kRealityGravity / unit);
  scene.solver.method = "implicit_euler";
  scene.solver.dt = kFoldStepLength;
  scene.solver.parameters = completeParameters(findSolver("implicit_euler"), {{"substeps", 1.0}});
  scene.solver.sleep.reset();
  Simulation simulation(scene);
  double height = 0.0, before = 0.0;
  // Until it changes by less than 1e-4 of itself in ten times the time in which a drop falls l / 2.
  const int apart = static_cast<int>(10.0 * std::sqrt(unit / kRealityGravity) / kFoldStepLength);
  for (int k = 1; k <= 40 * apart; ++k) {
    simulation.step();
    if (simulation.failed()) throw std::runtime_error("fold: " + simulation.failure());
    if (k % apart != 0) continue;
    before = height;
    height = 0.0;
    for (const Vec3& x : simulation.state().x.values()) height = std::max(height, x.z());
    if (std::abs(height - before) < 1e-4 * height) return height;
  }
  throw std::runtime_error("fold of " + fabric.name + ": did not come to rest");
}

}  // namespace cloth_sim
