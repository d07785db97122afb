/// \file Seams that tear through: how many pieces, how large, and what is held goes on being held.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

// ---- plans on stretched cloths
// -------------------------------------------------------------------

/// Tears a cloth of n x n along `seam`, stretched twofold everywhere, until nothing more fails.
Model tearThrough(int n, const MaterialPath& seam, const SpringSelection& springs) {
  ClothSpec spec = clothOf(n, n, 1.0 / (n - 1));
  spec.springs = springs;
  Model model = buildModel(spec);
  State state = flatState(model);
  for (Vec3& x : state.x) x *= 2.0;
  TearingSettings settings;
  settings.enabled = true;
  settings.ratio.fill(1.5);
  settings.seam = Seam{seam, 0.0};
  Tearing tearing(settings, model);
  for (int round = 0; round < 3 * model.mesh.faceCount(); ++round) {
    const SurgeryResult result =
        openSurface(model, state, tearing.plan(model, state), FailureCause::kTear);
    if (result.changes.mesh.empty()) break;
    tearing.follow(model, result.changes);
  }
  return model;
}

class ObliqueSeam : public testing::TestWithParam<int> {};

TEST_P(ObliqueSeam, EndsWithTwoPiecesWithinOneEdgeOfIt) {
  // Degrees from the u axis, through a point off the middle. The crack runs along edges within one
  // edge (a diagonal at most) of the seam, so an area may differ from that of the half plane by
  // seam length times edge length.
  const int n = 21;
  const double a = 1.0 / (n - 1);
  const double angle = GetParam() * M_PI / 180.0;
  const Vec2 middle(0.511, 0.487), along(std::cos(angle), std::sin(angle));
  const MaterialPath seam{middle - 1.5 * along, middle + 1.5 * along};
  const Model model = tearThrough(n, seam, {});
  EXPECT_EQ(describeDefect(model.mesh), "");
  const std::vector<double> areas = pieceAreas(model.mesh);
  ASSERT_EQ(areas.size(), 2U);
  EXPECT_NEAR(areas[0] + areas[1], 1.0, 1e-12);

  const TriangleMesh fine = makeGridMesh({401, 401, 1.0, 1.0});
  double left = 0.0;  // of the half plane
  for (FaceId f = 0; f < fine.faceCount(); ++f) {
    Vec2 centre = Vec2::Zero();
    for (VertexId v : fine.face(f)) centre += fine.material(v) / 3.0;
    if (sideOf(seam, centre) < 0.0) left += fine.restArea(f);
  }
  const double length = 1.5;  // more than the seam's within the cloth
  // Which piece is which: by the mean of the signed distance. Pieces keep to their sides: no face
  // of one has its centre an edge beyond the seam.
  const Pieces pieces = findPieces(model.mesh);
  std::array<double, 2> extreme{0.0, 0.0};
  double mean = 0.0;
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
    const Vec2& corner = model.mesh.material(model.mesh.face(f)[0]);
    if (pieces.ofFace[f] == 0) mean += sideOf(seam, corner);
  }
  const bool firstIsLeft = mean < 0.0;
  EXPECT_NEAR(areas[firstIsLeft ? 0 : 1], left, length * std::sqrt(2.0) * a);
  for (FaceId f = 0; f < model.mesh.faceCount(); ++f) {
    Vec2 centre = Vec2::Zero();
    for (VertexId v : model.mesh.face(f)) centre += model.mesh.material(v) / 3.0;
    const bool isLeft = (pieces.ofFace[f] == 0) == firstIsLeft;
    double& far = extreme[isLeft ? 0 : 1];
    far = std::max(far, isLeft ? sideOf(seam, centre) : -sideOf(seam, centre));
  }
  EXPECT_LT(extreme[0], std::sqrt(2.0) * a);
  EXPECT_LT(extreme[1], std::sqrt(2.0) * a);
}

INSTANTIATE_TEST_SUITE_P(Degrees, ObliqueSeam,
                         testing::Values(0, 10, 30, 45, 60, 80, 90, 120, 135, 150, 210, 330));

TEST(Seam, TearsThroughWithoutShearAndBendSpringsToo) {
  const MaterialPath seam{{0.33, -0.1}, {0.61, 1.1}};
  for (const SpringSelection& springs :
       {SpringSelection{false, false}, SpringSelection{true, false},
        SpringSelection{false, true}}) {
    EXPECT_EQ(pieceAreas(tearThrough(15, seam, springs).mesh).size(), 2U);
  }
}

TEST(Seam, OfAPolylineTearsThroughToo) {
  const Model model = tearThrough(21, {{0.3, -0.1}, {0.42, 0.5}, {0.71, 1.1}}, {});
  EXPECT_EQ(describeDefect(model.mesh), "");
  EXPECT_EQ(pieceAreas(model.mesh).size(), 2U);
}

TEST(Notch, InAnObliqueDirectionOpensWhereItGoes) {
  // From the lower border towards the upper left, 40 degrees off the v axis. Every structural
  // spring across it is gone, every new vertex is within one edge of it, and the cloth holds
  // together.
  ClothSpec spec = clothOf(21, 21, 0.05);
  Model model = buildModel(spec);
  State state = flatState(model);
  const MaterialPath path{{0.62, 0.0}, {0.62 - 0.35 * std::sin(0.7), 0.35 * std::cos(0.7)}};
  const SurgeryResult result =
      openSurface(model, state, planNotch(model, path), FailureCause::kCut);
  EXPECT_EQ(describeDefect(model.mesh), "");
  EXPECT_EQ(findPieces(model.mesh).count, 1);
  EXPECT_GE(result.changes.mesh.newVertices.size(), 5U);
  for (const NewVertex& added : result.changes.mesh.newVertices) {
    EXPECT_LT(distanceTo(path, model.mesh.material(added.id)), 0.05 * std::sqrt(2.0));
  }
  int structural = 0;
  for (const FailureEvent& event : result.events) {
    EXPECT_EQ(event.cause, FailureCause::kCut);
    EXPECT_LT(distanceTo(path, event.material), 0.05 * std::sqrt(2.0));
    structural += event.kind == SpringKind::kStructural ? 1 : 0;
  }
  EXPECT_GE(structural, 5);
}

// ---- whole scenes
// --------------------------------------------------------------------------------

/// A cloth that two clamps pull apart along its middle, without gravity.
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

INSTANTIATE_TEST_SUITE_P(Registry, SeamScene, testing::ValuesIn(solverNames()),
                         [](const auto& test) { return test.param; });

TEST_P(SeamScene, TearsIntoTwoPiecesOfTheExpectedAreas) {
  // The seam lies between columns 7 (u = 0.21) and 8 (0.24): column 8 opens, so the left piece is
  // 8 cells wide and the right one 7, of 0.03 m each; both 0.45 m high.
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
  EXPECT_EQ(describeDefect(simulation.model().mesh), "");
  EXPECT_NEAR(totalMass(simulation.model()), mass, 1e-12 * mass);
  EXPECT_EQ(simulation.model().mesh.totalRestArea(), area);
  EXPECT_TRUE(isFinite(simulation.state()));
  const std::vector<double> areas = pieceAreas(simulation.model().mesh);
  ASSERT_EQ(areas.size(), 2U);
  EXPECT_NEAR(areas[0], 8 * 0.03 * 0.45, 1e-12);
  EXPECT_NEAR(areas[1], 7 * 0.03 * 0.45, 1e-12);

  int overloaded = 0;
  for (const FailureEvent& event : simulation.takeEvents()) {
    EXPECT_EQ(event.cause, FailureCause::kTear);
    if (event.kind == SpringKind::kStructural) {
      EXPECT_NEAR(event.material.x(), 0.225, 1e-12) << "failed structural springs cross the seam";
    }
    if (!event.overloaded) continue;
    ++overloaded;
    EXPECT_GT(event.stretch, 1.5);
  }
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
  // Column 5 is what opens. Row 0 of it is pinned; rows 8 to 10 are in the patch.
  const std::vector<VertexId>& held = simulation.clamps()[0].held();
  int pinnedCopies = 0, heldCopies = 0;
  for (VertexId v = 121; v < model.particleCount(); ++v) {
    const Vec2 place = model.mesh.material(v);
    EXPECT_NEAR(place.x(), 0.15, 1e-12);
    const int row = static_cast<int>(std::lround(place.y() / 0.03));
    const VertexId twin = model.grid->vertex(5, row);
    if (row == 0) {
      ++pinnedCopies;
      EXPECT_EQ(state.x[v], state.x[twin]);
      EXPECT_NEAR(state.x[v].z(), 0.85, 1e-12);
    } else if (row >= 8) {
      ++heldCopies;
      EXPECT_TRUE(std::binary_search(held.begin(), held.end(), v)) << "row " << row;
      EXPECT_EQ(state.x[v], state.x[twin]);
    }
  }
  EXPECT_EQ(pinnedCopies, 1);
  EXPECT_EQ(heldCopies, 3);
  EXPECT_EQ(held.size(), 9U + 3U);
  EXPECT_TRUE(std::is_sorted(held.begin(), held.end()));
}

}  // namespace
}  // namespace cloth_sim
