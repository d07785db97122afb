/// \file Cut and refine commands of a simulation: their replies and effects.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "surgery/geometry.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace surgery_support;
using testing::HasSubstr;

/// A scene with a cloth of 0.4 m that hangs in y = 0 from its upper row; x = u - 0.2, z = v + 0.8.
std::string hanging(const std::string& method, const std::string& surgery = "",
                    const std::string& more = "") {
  return R"(
cloth:
  size: [0.4, 0.4]
  particles: [17, 17]
  pose: {position: [0, 0, 1], rpy: [1.5707963267948966, 0, 0]}
  fabric: {preset: interlock, damping: 2.0e-5}
  pins: [last_row]
  surgery: {)" +
         surgery + R"(}
solver: {method: )" +
         method + R"(, dt: 0.0166666666666666667, substeps: 60}
drag: 1.0
)" + more;
}

Simulation simulationOf(const std::string& yaml) {
  return Simulation(parseScene(yaml, "cut.yaml"));
}

/// Returns a command to cut along a path in the plane of the cloth.
CutAlong along(const std::vector<Vec3>& path, double halfWidth = 0.0) {
  CutAlong command{strokeAlong(path, Vec3::UnitY(), 0.5)};
  command.stroke.halfWidth = halfWidth;
  return command;
}

void run(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.step();
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
}

std::uint64_t hashOf(const Simulation& simulation) {
  return stateHash(simulation.model(), simulation.state());
}

class SurgeryCommand : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Registry, SurgeryCommand, testing::ValuesIn(boundedSolverNames()),
                         [](const auto& test) { return test.param; });

TEST_P(SurgeryCommand, ACutAcrossDropsTheLowerPart) {
  Simulation simulation = simulationOf(hanging(GetParam()));
  run(simulation, 10);
  const double mass = totalMass(simulation.model());
  const CommandResult result = simulation.apply(along({{-0.5, 0, 0.913}, {0.5, 0, 0.961}}));
  ASSERT_TRUE(result.success) << result.message;
  EXPECT_THAT(result.message, HasSubstr("2 pieces"));
  EXPECT_EQ(simulation.pieces(), 2);
  EXPECT_EQ(simulation.broken().total, simulation.broken().cut);
  // Of 17 columns, and of the row at z = 0.9375, unless the cloth has sunk from the stroke.
  EXPECT_THAT(simulation.broken().byKind[0], testing::AnyOf(17, 18));
  EXPECT_EQ(simulation.takeEvents().size(), static_cast<std::size_t>(simulation.broken().total));
  EXPECT_NEAR(totalMass(simulation.model()), mass, 1e-12 * mass);
  run(simulation, 60);
  const std::vector<PieceSnapshot> pieces = simulation.describePieces();
  ASSERT_EQ(pieces.size(), 2U);
  // A second of free fall against the drag; what is pinned hangs on.
  const double low = std::min(pieces[0].centreOfMass.z(), pieces[1].centreOfMass.z());
  const double high = std::max(pieces[0].centreOfMass.z(), pieces[1].centreOfMass.z());
  EXPECT_LT(low, -1.0);
  EXPECT_GT(high, 0.8);
}

TEST_P(SurgeryCommand, ACutThroughTheClampAndThePinsLeavesThemWhereTheyAre) {
  Simulation simulation = simulationOf(hanging(GetParam(), "", R"(
clamps:
  grip: {patch: {particle: [8, 4], radius: 2}, closing_speed: 5.0, gap_open: 0.1, gap_closed: 0.01}
)"));
  ASSERT_TRUE(simulation.apply(SetGrasp{"grip", true}).success);
  run(simulation, 4);  // later it is folded, and the stroke may cut the tip of a fold off as well
  ASSERT_EQ(simulation.clamps()[0].held().size(), 25U);
  const State before = simulation.state();
  const Vec2 corner = simulation.model().mesh.material(16 * 17);
  ASSERT_TRUE(simulation.apply(along({{0.013, 0, 1.5}, {-0.021, 0, 0.5}})).success);
  EXPECT_EQ(simulation.pieces(), 2);
  for (VertexId v : simulation.clamps()[0].held()) {
    if (v >= 17 * 17) continue;
    EXPECT_EQ(simulation.state().x[v], before.x[v]);
  }
  EXPECT_GT(simulation.clamps()[0].held().size(), 25U) << "what is cut in its grip stays in it";
  EXPECT_EQ(simulation.model().mesh.material(16 * 17), corner);
  run(simulation, 30);
  // Pins: every particle of the upper border, also where it was cut.
  int pinned = 0;
  for (VertexId v = 0; v < simulation.model().particleCount(); ++v) {
    if (simulation.model().mesh.material(v).y() < 0.4 - 1e-12) continue;
    ++pinned;
    EXPECT_NEAR(simulation.state().x[v].z(), 1.2, 1e-12);
  }
  EXPECT_GT(pinned, 17);
}

TEST_P(SurgeryCommand, RefinedClothHangsOn) {
  Simulation simulation = simulationOf(hanging(GetParam()));
  run(simulation, 10);
  const double mass = totalMass(simulation.model());
  const CommandResult result = simulation.apply(RefineMesh{{{Vec3(0, 0, 1)}, {0.06, 2, 0.0}}});
  ASSERT_TRUE(result.success) << result.message;
  EXPECT_THAT(result.message, HasSubstr("particles added"));
  EXPECT_GT(simulation.model().particleCount(), 17 * 17 + 20);
  EXPECT_EQ(simulation.broken().total, 0) << "nothing failed";
  EXPECT_NEAR(totalMass(simulation.model()), mass, 1e-12 * mass);
  run(simulation, 60);
  EXPECT_LT(simulation.observeMaxStretch(), 1.2);
  EXPECT_EQ(simulation.pieces(), 1);
}

TEST(SurgeryAnswers, AMissChangesNothing) {
  Simulation simulation = simulationOf(hanging("xpbd"));
  run(simulation, 3);
  const std::uint64_t hash = hashOf(simulation);
  const auto topology = simulation.snapshot()->topology;
  const CommandResult result = simulation.apply(along({{-0.5, 0, 2.0}, {0.5, 0, 2.0}}));
  EXPECT_TRUE(result.success);
  EXPECT_EQ(result.message, "the stroke misses the cloth: nothing was cut");
  EXPECT_EQ(simulation.apply(RefineMesh{{{Vec3(5, 5, 5)}, {0.05, 3, 0.0}}}).message,
            "0 particles added");
  EXPECT_EQ(hashOf(simulation), hash);
  EXPECT_EQ(simulation.snapshot()->topology, topology);
}

TEST(SurgeryAnswers, TooManyParticlesAreRefusedAndNothingChanges) {
  Simulation simulation = simulationOf(hanging("xpbd", "max_particles: 300"));
  Simulation untouched = simulationOf(hanging("xpbd", "max_particles: 300"));
  run(simulation, 3);
  run(untouched, 3);
  for (const Command& command :
       std::vector<Command>{along({{-0.5, 0, 0.913}, {0.5, 0, 0.961}}),
                            RefineMesh{{{Vec3(0, 0, 1)}, {0.2, 4, 0.0}}}}) {
    const CommandResult result = simulation.apply(command);
    EXPECT_FALSE(result.success);
    EXPECT_THAT(result.message, HasSubstr("max_particles"));
    EXPECT_EQ(hashOf(simulation), hashOf(untouched));
  }
  run(simulation, 10);
  run(untouched, 10);
  EXPECT_EQ(hashOf(simulation), hashOf(untouched));
}

TEST(SurgeryScene, SmallScrapsAreTakenAwayAndCounted) {
  Simulation simulation = simulationOf(hanging("xpbd", "drop_below: 0.01"));
  const double mass = totalMass(simulation.model());
  const double area = simulation.model().mesh.totalRestArea();
  std::vector<Vec3> circle;
  for (int k = 0; k <= 24; ++k) {
    const double angle = 2.0 * M_PI * (k % 24) / 24.0;
    circle.emplace_back(0.05 * std::cos(angle), 0.0, 0.97 + 0.05 * std::sin(angle));
  }
  ASSERT_TRUE(simulation.apply(along(circle)).success);
  EXPECT_EQ(simulation.pieces(), 1);
  EXPECT_EQ(simulation.dropped().count, 1);
  EXPECT_NEAR(simulation.dropped().restArea, M_PI * 0.0025, 0.05 * M_PI * 0.0025);
  EXPECT_NEAR(simulation.dropped().mass + totalMass(simulation.model()), mass, 1e-12 * mass);
  EXPECT_NEAR(simulation.dropped().restArea + simulation.model().mesh.totalRestArea(), area,
              1e-12 * area);
  // Half the cloth is no scrap, and neither is a pinned corner.
  ASSERT_TRUE(simulation.apply(along({{-0.5, 0, 0.897}, {0.5, 0, 0.881}})).success);
  ASSERT_TRUE(
      simulation.apply(along({{-0.17, 0, 1.5}, {-0.14, 0, 1.15}, {-0.5, 0, 1.13}})).success);
  EXPECT_EQ(simulation.dropped().count, 1);
  EXPECT_EQ(simulation.pieces(), 3);
  run(simulation, 20);
}

TEST(SurgeryScene, StripsAreRemovedOnlyIfTheSceneSaysSo) {
  const CutAlong stroke = along({{-0.1, 0, 0.987}, {0.1, 0, 1.013}}, 0.04);
  Simulation plain = simulationOf(hanging("xpbd"));
  EXPECT_THAT(plain.apply(stroke).message, testing::Not(HasSubstr("removed")));
  EXPECT_EQ(plain.dropped().count, 0);
  Simulation stripped = simulationOf(hanging("xpbd", "clear_strip: true"));
  const double mass = totalMass(stripped.model());
  const double area = stripped.model().mesh.totalRestArea();
  const int springs = stripped.model().springs.count();
  const CommandResult result = stripped.apply(stroke);
  EXPECT_THAT(result.message, HasSubstr(" m^2 removed, 1 pieces"));
  EXPECT_GT(stripped.broken().cut, plain.broken().cut);
  EXPECT_LT(stripped.model().springs.count(), springs);
  // Counted as what went, and all of it.
  EXPECT_EQ(stripped.pieces(), 1);
  EXPECT_GE(stripped.dropped().count, 1);
  EXPECT_GT(stripped.dropped().restArea, 0.2 * 0.04);
  EXPECT_NEAR(stripped.dropped().restArea + stripped.model().mesh.totalRestArea(), area,
              1e-12 * area);
  EXPECT_NEAR(stripped.dropped().mass + totalMass(stripped.model()), mass, 1e-12 * mass);
  run(stripped, 20);
}

TEST(SurgeryScene, StripsGoBetweenLayersToo) {
  Simulation simulation =
      simulationOf("self_contact: true\n" + hanging("line_xpbd", "clear_strip: true"));
  ASSERT_TRUE(simulation.apply(along({{-0.1, 0, 0.987}, {0.1, 0, 1.013}}, 0.04)).success);
  EXPECT_GT(simulation.dropped().restArea, 0.0);
  run(simulation, 20);
}

TEST(SurgeryScene, AStripThatIsTheWholeClothIsRefused) {
  // Without its pins, whose faces would stay.
  Simulation simulation(
      parseScene(hanging("xpbd", "clear_strip: true"), "cut.yaml", {"cloth.pins=null"}));
  const std::uint64_t hash = hashOf(simulation);
  const CommandResult result = simulation.apply(along({{-0.5, 0, 0.987}, {0.5, 0, 1.013}}, 0.5));
  EXPECT_FALSE(result.success);
  EXPECT_EQ(result.message,
            "the half_width of the stroke is too large: nothing of cloth 'cloth' would be left");
  EXPECT_EQ(hashOf(simulation), hash);
}

TEST(SurgeryScene, PhasesRefineNotchAndCutInThisOrder) {
  Simulation simulation =
      simulationOf(hanging("xpbd", "refine_cuts: {radius: 0.02, generations: 2}",
                           R"(
phases:
  - {name: wait, timeout: 0.05}
  - name: operate
    refine: {point: [0, 0, 1.1], radius: 0.05, generations: 2}
    notch: [[0.1, 0.0], [0.11, 0.13]]
    cut: {path: [[-0.5, 0, 1.05], [0.5, 0, 1.07]], direction: [0, 1, 0]}
    timeout: 0.2
)"));
  run(simulation, 20);
  EXPECT_EQ(simulation.pieces(), 2);
  EXPECT_GT(simulation.model().particleCount(), 17 * 17 + 100);
  EXPECT_LT(nearestTo({0.11, 0.13}, simulation.model().mesh), 1e-9);
  EXPECT_EQ(simulation.broken().torn, 0);
}

}  // namespace
}  // namespace cloth_sim
