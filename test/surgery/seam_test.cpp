/// \file Tears along seams: their line, the number of pieces, and held particles.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "surgery/geometry.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace surgery_support;

// ---- plans on stretched cloths -----------------------------------------------------------------

/// Tears a cloth that is stretched by a factor of two along `seam`, until nothing more fails.
Model tearThrough(const ClothSpec& spec, const MaterialPath& seam) {
  Model model = buildModel(spec);
  State state = flatState(model);
  state.t = 1.0;
  for (Vec3& x : state.x) x *= 2.0;
  TearingSettings settings;
  settings.enabled = true;
  settings.ratio.fill(1.5);
  settings.seam = Seam{seam, 0.0};
  settings.tipSpeed = 1e9;
  Tearing tearing(settings, model);
  for (int round = 0; round < 3 * model.mesh.faceCount(); ++round) {
    const CutPlan plan = tearing.plan(model, state, 0.01);
    if (plan.paths.empty()) break;
    const SurgeryResult result = cut(plan, usualLimits(model.mesh), {}, model, state);
    tearing.noteOpened(result);
    tearing.applyChanges(model, result.changes);
    state.t += 0.01;
  }
  return model;
}

ClothSpec squareSpec(int n) { return clothOf(n, n, 1.0 / (n - 1)); }

class ObliqueSeam : public testing::TestWithParam<int> {};

TEST_P(ObliqueSeam, EndsWithTwoPiecesOnItsSides) {
  // Degrees from the u axis, through a point off the middle.
  const double angle = GetParam() * M_PI / 180.0;
  const Vec2 middle(0.511, 0.487), along(std::cos(angle), std::sin(angle));
  const MaterialPath seam{middle - 1.5 * along, middle + 1.5 * along};
  const Model model = tearThrough(squareSpec(21), seam);
  EXPECT_EQ(validationError(model.mesh), "");
  const double left = areaLeftOf(rectangle(1.0, 1.0), middle, along);
  const std::vector<double> areas = sortedAreas(model.mesh);
  ASSERT_EQ(areas.size(), 2U);
  EXPECT_NEAR(areas[0], std::min(left, 1.0 - left), 1e-9);
  EXPECT_NEAR(areas[1], std::max(left, 1.0 - left), 1e-9);
  EXPECT_LT(farthestFrom(seam, model.mesh), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Degrees, ObliqueSeam,
                         testing::Values(0, 10, 30, 45, 60, 80, 90, 120, 134, 150, 210, 330));

TEST(Seam, TearsThroughWithoutShearAndBendSpringsToo) {
  const MaterialPath seam{{0.33, -0.1}, {0.61, 1.1}};
  for (const SpringSelection& springs :
       {SpringSelection{false, false}, SpringSelection{true, false},
        SpringSelection{false, true}}) {
    ClothSpec spec = squareSpec(15);
    spec.springs = springs;
    EXPECT_EQ(pieceAreas(tearThrough(spec, seam).mesh).size(), 2U);
  }
}

TEST(Seam, AlongEdgesAndThroughVerticesTearsThroughToo) {
  for (const MaterialPath& seam :
       {MaterialPath{{0.5, 0.0}, {0.5, 1.0}}, MaterialPath{{0.0, 0.25}, {1.0, 0.25}},
        MaterialPath{{0.0, 0.0}, {1.0, 1.0}}, MaterialPath{{0.0, 1.0}, {1.0, 0.0}},
        MaterialPath{{0.25, 0.0}, {0.75, 1.0}}}) {
    const Model model = tearThrough(squareSpec(17), seam);
    EXPECT_EQ(validationError(model.mesh), "");
    EXPECT_EQ(pieceAreas(model.mesh).size(), 2U)
        << seam[0].transpose() << " - " << seam[1].transpose();
    EXPECT_LT(farthestFrom(seam, model.mesh), 1e-9);
  }
}

TEST(Seam, PastACornerNearerThanTheShortestEdgeBendsToIt) {
  // The seam meets the borders 2 mm from two corners, where the shortest edge is 2.5 mm, and
  // corners stay.
  const MaterialPath seam{{1.098, -0.1}, {-0.1, 1.098}};
  const Model model = tearThrough(squareSpec(21), seam);
  EXPECT_EQ(validationError(model.mesh), "");
  EXPECT_EQ(pieceAreas(model.mesh).size(), 2U);
  EXPECT_LT(farthestFrom(seam, model.mesh), 0.002);
}

TEST(Seam, OfAPolylineTearsExactlyAlongIt) {
  const MaterialPath seam{{0.3, -0.1}, {0.42, 0.5}, {0.71, 0.52}, {0.66, 1.1}};
  const Model model = tearThrough(squareSpec(21), seam);
  EXPECT_EQ(validationError(model.mesh), "");
  EXPECT_EQ(pieceAreas(model.mesh).size(), 2U);
  EXPECT_LT(farthestFrom(seam, model.mesh), 1e-9);
}

TEST(Notch, InAnObliqueDirectionOpensWhereItGoes) {
  // From the lower border towards the upper left, 40 degrees off the v axis: it lies where it
  // should, the springs across it are gone, and the cloth holds together.
  Model model = buildModel(clothOf(21, 21, 0.05));
  State state = flatState(model);
  const MaterialPath path{{0.62, 0.0}, {0.62 - 0.35 * std::sin(0.7), 0.35 * std::cos(0.7)}};
  CutPlan plan;
  const Vec3 from(path[0].x(), path[0].y(), 0.0), to(path[1].x(), path[1].y(), 0.0);
  plan.paths = findPaths(strokeAlong({from, to}, Vec3::UnitZ(), 1.0), model.mesh, state.x);
  std::multiset<SpringKind> crossing;
  for (const Spring& spring : model.springs.slots()) {
    if (separates(path, model.mesh.material(spring.a), model.mesh.material(spring.b))) {
      crossing.insert(spring.kind);
    }
  }
  const SurgeryResult result = cut(plan, usualLimits(model.mesh), {}, model, state);
  EXPECT_EQ(validationError(model.mesh), "");
  EXPECT_EQ(connectedComponents(model.mesh).count, 1);
  EXPECT_LT(farthestFrom(path, model.mesh), 1e-9);
  EXPECT_NEAR(result.length, 0.35, 1e-9);
  std::multiset<SpringKind> failed;
  for (const FailureEvent& event : result.events) {
    EXPECT_EQ(event.cause, FailureCause::kCut);
    EXPECT_LT(distanceTo(path, event.material), 0.05 * std::sqrt(2.0));
    failed.insert(event.kind);
  }
  EXPECT_EQ(failed, crossing) << "also where a vertex moved onto the cut";
  EXPECT_EQ(failed.count(SpringKind::kStructural), 11U) << "6 rows, 5 columns";
  for (const Spring& spring : model.springs.slots()) {
    if (!spring.exists()) continue;
    EXPECT_FALSE(separates(path, model.mesh.material(spring.a), model.mesh.material(spring.b)));
  }
}

// ---- whole scenes ------------------------------------------------------------------------------

/// A scene in which two clamps pull a cloth apart along its middle, without gravity.
std::string pullScene(const std::string& method) {
  return R"(
cloth:
  size: [0.45, 0.45]
  particles: [16, 16]
  fabric: {preset: interlock, damping: 1.0e-4}
solver: {method: )" +
         method + R"(, dt: 0.0166666666666666667, substeps: 60}
gravity: [0, 0, 0]
drag: 1.0
clamps:
  left: {patch: {particle: [1, 8], radius: 8}, closing_speed: 5.0, gap_open: 0.1, gap_closed: 0.01}
  right: {patch: {particle: [14, 8], radius: 8}, closing_speed: 5.0, gap_open: 0.1, gap_closed: 0.01}
tearing:
  ratio: 1.5
  seam: {path: [[0.225, -0.02], [0.225, 0.47]]}
phases:
  - {name: hold, clamps: {all: {grasp: true}}, until: {clamps: closed}, timeout: 2.0}
  - name: pull
    clamps: {left: {move_by: [-0.3, 0, 0]}, right: {move_by: [0.3, 0, 0]}}
    until: {pieces: 2}
    timeout: 4.0
  - {name: rest, timeout: 0.1}
)";
}

class SeamScene : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Registry, SeamScene, testing::ValuesIn(boundedSolverNames()),
                         [](const auto& test) { return test.param; });

TEST_P(SeamScene, TearsIntoTwoPiecesOfTheExpectedAreas) {
  // The seam lies half-way between columns 7 (u = 0.21) and 8 (0.24), and so between the borders.
  std::string yaml = pullScene(GetParam());
  // Patches of radius 8 would take the middle too: keep to three columns each.
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = yaml.find(from); at != std::string::npos; at = yaml.find(from)) {
      yaml.replace(at, from.size(), to);
    }
  };
  replace("radius: 8", "radius: 3");
  Simulation simulation(parseScene(yaml, "pull.yaml"));
  const double mass = totalMass(simulation.model());
  const double area = simulation.model().mesh.totalRestArea();
  while (simulation.script().status() != ScriptStatus::kDone && !simulation.failed()) {
    simulation.step();
  }
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_EQ(simulation.pieces(), 2);
  EXPECT_EQ(validationError(simulation.model().mesh), "");
  EXPECT_NEAR(totalMass(simulation.model()), mass, 1e-12 * mass);
  EXPECT_NEAR(simulation.model().mesh.totalRestArea(), area, 1e-12 * area);
  EXPECT_LT(farthestFrom({{0.225, 0.0}, {0.225, 0.45}}, simulation.model().mesh), 1e-12);
  EXPECT_TRUE(isFinite(simulation.state()));
  const std::vector<double> areas = pieceAreas(simulation.model().mesh);
  ASSERT_EQ(areas.size(), 2U);
  EXPECT_NEAR(areas[0], 0.225 * 0.45, 1e-12);
  EXPECT_NEAR(areas[1], 0.225 * 0.45, 1e-12);

  int overloaded = 0;
  std::set<long> rows;
  for (const FailureEvent& event : simulation.takeEvents()) {
    EXPECT_EQ(event.cause, FailureCause::kTear);
    if (event.kind == SpringKind::kStructural) {
      EXPECT_NEAR(event.material.x(), 0.225, 1e-12) << "failed structural springs cross the seam";
      EXPECT_TRUE(rows.insert(std::lround(event.material.y() / 0.03)).second) << "each once";
    }
    if (!event.overloaded) continue;
    ++overloaded;
    EXPECT_GT(event.stretch, 1.5);
  }
  EXPECT_EQ(rows.size(), 16U);
  EXPECT_GE(overloaded, 8);
  for (const Clamp& clamp : simulation.clamps()) EXPECT_EQ(clamp.held().size(), 5U * 7U);
}

TEST_P(SeamScene, CopiesOfHeldParticlesAreHeldAtTheSamePlace) {
  // A clamp holds a patch across a notch, and a pin the corner that is cut off.
  const std::string yaml = R"(
cloth:
  size: [0.3, 0.3]
  particles: [11, 11]
  pose: {position: [0, 0, 1], rpy: [1.5707963267948966, 0, 0]}
  fabric: interlock
  pins: [first_row]
solver: {method: )" + GetParam() +
                           R"(, dt: 0.0166666666666666667, substeps: 60}
clamps:
  top: {patch: {particle: [5, 9], radius: 1}, closing_speed: 5.0, gap_open: 0.1, gap_closed: 0.01}
phases:
  - {name: hold, clamps: {all: {grasp: true}}, until: {clamps: closed}, timeout: 2.0}
  - {name: cut, notch: [[[0.135, 0.0], [0.135, 0.1]], [[0.135, 0.22], [0.135, 0.3]]], timeout: 0.3}
)";
  Simulation simulation(parseScene(yaml, "held.yaml"));
  while (simulation.script().status() != ScriptStatus::kDone && !simulation.failed()) {
    simulation.step();
  }
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  const Model& model = simulation.model();
  const State& state = simulation.state();
  ASSERT_GT(model.particleCount(), 121);
  // The notches run half-way between columns 4 and 5. Row 0 is pinned, rows 8 to 10 are in the
  // patch: what is made between held particles is held too, and so are both sides of the opening.
  const std::vector<VertexId>& held = simulation.clamps()[0].held();
  std::map<double, std::vector<VertexId>> byHeight;  // new particles that are held
  for (VertexId v = 121; v < model.particleCount(); ++v) {
    const Vec2 place = model.mesh.material(v);
    EXPECT_NEAR(place.x(), 0.135, 1e-12);
    const bool inPatch = place.y() > 0.24 - 1e-9;
    EXPECT_EQ(std::binary_search(held.begin(), held.end(), v), inPatch) << place.transpose();
    if (inPatch || place.y() < 1e-9) byHeight[place.y()].push_back(v);
    if (place.y() < 1e-9) {
      EXPECT_NEAR((state.x[v] - Vec3(-0.015, 0.0, 0.85)).norm(), 0.0, 1e-12);
    }
  }
  // At the pinned border, and in the patch at every row and every diagonal between rows.
  EXPECT_EQ(byHeight.size(), 1U + 5U);
  for (const auto& [height, pair] : byHeight) {
    ASSERT_EQ(pair.size(), 2U) << "v = " << height;
    EXPECT_EQ(state.x[pair[0]], state.x[pair[1]]) << "v = " << height;
  }
  EXPECT_EQ(held.size(), 9U + 10U);
  EXPECT_TRUE(std::is_sorted(held.begin(), held.end()));
}

}  // namespace
}  // namespace cloth_sim
