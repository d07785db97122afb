/// \file The simulation's commands, snapshots and summary.

#include "cloth_sim/sim/simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/summary.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const char* const kScene = R"(
seed: 4
cloth:
  size: [0.4, 0.3]
  particles: [9, 7]
  pose: {position: [0, 0, 0.2]}
  random_offset: [0.02, 0.03, 0.0]
  fabric: silk
  pins: [corner_00]
solver: {method: xpbd, dt: 0.01, substeps: 5}
drag: 0.5
obstacles:
  ball: {type: sphere, radius: 0.05, position: [0, 0, 0.1]}
  ground: {type: plane}
clamps:
  left: {patch: {particle: [1, 3], radius: 1}, gap_open: 0.1, gap_closed: 0.02}
  right: {patch: {particle: [7, 3], radius: 1}, gap_open: 0.1, gap_closed: 0.02}
tearing: {ratio: 1.5}
phases:
  - {name: fall, timeout: 0.1}
  - name: notch
    notch: [[0.225, 0.0], [0.225, 0.11]]
    timeout: 0.1
  - {name: stop, timeout: 10.0}
)";

Simulation simulationOf(const std::vector<std::string>& overrides = {}) {
  return Simulation(parseScene(kScene, "bench.yaml", overrides));
}

void run(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.step();
}

std::uint64_t hashOf(const Simulation& simulation) {
  return stateHash(simulation.model(), simulation.state());
}

// ---- start

TEST(Simulation, StartsWhereTheSceneSays) {
  const Simulation simulation = simulationOf();
  EXPECT_EQ(simulation.time(), 0.0);
  EXPECT_EQ(simulation.stepCount(), 0U);
  EXPECT_EQ(simulation.model().particleCount(), 63);
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : simulation.state().x) middle += x / 63.0;
  EXPECT_LE(std::abs(middle.x()), 0.02);
  EXPECT_LE(std::abs(middle.y()), 0.03);
  EXPECT_NEAR(middle.z(), 0.2, 1e-15) << "no random offset along z";
}

TEST(Simulation, TheSeedDecidesTheOffset) {
  EXPECT_EQ(hashOf(simulationOf()), hashOf(simulationOf()));
  EXPECT_NE(hashOf(simulationOf()), hashOf(simulationOf({"seed=5"})));
}

TEST(Simulation, PinnedParticlesStayWhereTheyAre) {
  Simulation simulation = simulationOf();
  const Vec3 corner = simulation.state().x[0];
  run(simulation, 30);
  EXPECT_EQ(simulation.state().x[0], corner);
  EXPECT_NEAR(simulation.time(), 0.3, 1e-12);
}

TEST(Simulation, AnObstacleFarAwayChangesNothing) {
  Simulation alone = simulationOf({"obstacles=null", "phases=null"});
  Simulation far = simulationOf(
      {"obstacles={far: {type: sphere, radius: 0.1, position: [9, 0, 0]}}", "phases=null"});
  for (int k = 0; k < 30; ++k) {
    alone.step();
    far.step();
    ASSERT_EQ(hashOf(alone), hashOf(far)) << "step " << k;
    ASSERT_TRUE(far.contacts().empty());
  }
}

// ---- commands

struct BadCommand {
  const char* name;
  Command command;
  const char* message;  ///< a part of it
};

Pose poseOf(const Vec3& position, const Quat& orientation = Quat::Identity()) {
  return Pose{position, orientation};
}

const double kNan = std::numeric_limits<double>::quiet_NaN();
const double kInf = std::numeric_limits<double>::infinity();

Stroke strokeTo(const Vec3& end) {
  return strokeAlong({Vec3(0.0, -1.0, 0.2), end}, Vec3::UnitZ(), 0.1);
}

class RefusedCommand : public testing::TestWithParam<BadCommand> {};

TEST_P(RefusedCommand, ChangesNothing) {
  Simulation simulation = simulationOf();
  Simulation untouched = simulationOf();
  run(simulation, 5);
  run(untouched, 5);
  const CommandResult result = simulation.apply(GetParam().command);
  EXPECT_FALSE(result.success);
  EXPECT_THAT(result.message, HasSubstr(GetParam().message));
  EXPECT_EQ(hashOf(simulation), hashOf(untouched));
  // Nor does it show later: targets, phases, gravity and obstacles are what they were.
  EXPECT_EQ(simulation.script().history().size(), untouched.script().history().size());
  run(simulation, 25);
  run(untouched, 25);
  EXPECT_EQ(hashOf(simulation), hashOf(untouched));
}

INSTANTIATE_TEST_SUITE_P(
    All, RefusedCommand,
    testing::Values(
        BadCommand{"TargetOfUnknownClamp", SetClampTarget{"middle", Pose{}},
                   "unknown clamp 'middle' (known: left, right)"},
        BadCommand{"TargetNotANumber", SetClampTarget{"left", poseOf({0.0, kNan, 0.0})},
                   "position: expected three finite numbers"},
        BadCommand{"TargetInfinite", SetClampTarget{"left", poseOf({kInf, 0.0, 0.0})},
                   "position: expected three finite numbers"},
        BadCommand{"TargetTurnedByNoUnitQuaternion",
                   SetClampTarget{"left", poseOf(Vec3::Zero(), Quat(1.0, 1.0, 0.0, 0.0))},
                   "orientation: expected a unit quaternion (its norm is 1.41"},
        BadCommand{"TargetTurnedByZero",
                   SetClampTarget{"left", poseOf(Vec3::Zero(), Quat(0.0, 0.0, 0.0, 0.0))},
                   "orientation: expected a unit quaternion"},
        BadCommand{"TargetTurnedByNan",
                   SetClampTarget{"left", poseOf(Vec3::Zero(), Quat(kNan, 0.0, 0.0, 0.0))},
                   "orientation: expected four finite numbers"},
        BadCommand{"GraspOfUnknownClamp", SetGrasp{"Left", true}, "unknown clamp 'Left'"},
        BadCommand{"ReleaseOfUnknownClamp", SetGrasp{"", false}, "unknown clamp ''"},
        BadCommand{"UnknownPhase", SetPhase{"dance"},
                   "unknown phase 'dance' (known: fall, notch, stop)"},
        BadCommand{"EmptyPhase", SetPhase{""}, "unknown phase ''"},
        BadCommand{"GravityNotANumber", SetGravity{{0.0, 0.0, kNan}}, "gravity"},
        BadCommand{"GravityInfinite", SetGravity{{0.0, -kInf, 0.0}}, "gravity"},
        BadCommand{"UnknownObstacle", MoveObstacle{"wall", Pose{}, Vec3::Zero()},
                   "unknown obstacle 'wall' (known: ball, ground)"},
        BadCommand{"ObstacleToNowhere", MoveObstacle{"ball", poseOf({kNan, 0, 0}), Vec3::Zero()},
                   "position"},
        BadCommand{"ObstacleAtNoSpeed", MoveObstacle{"ball", Pose{}, Vec3(0, kNan, 0)}, "velocity"},
        BadCommand{"TearRatioOfOne", SetTearing{true, {1.0, 2.0, 2.0}},
                   "tear ratio: expected numbers > 1"},
        BadCommand{"TearRatioNotANumber", SetTearing{true, {2.0, kNan, 2.0}}, "tear ratio"},
        BadCommand{"CutWithOnePose", CutAlong{Stroke{{Blade{}}, false, 0.0}}, "pose"},
        BadCommand{"CutNotANumber", CutAlong{strokeTo({kNan, 0.0, 0.2})}, "finite"},
        BadCommand{"CutToInfinity", CutAlong{strokeTo({0.1, kInf, 0.2})}, "finite"},
        BadCommand{"RefineNowhere", RefineMesh{{{}, {0.1, 2, 0.0}}}, "the path is empty"},
        BadCommand{"RefineNotANumber", RefineMesh{{{Vec3(0.0, kNan, 0.2)}, {0.1, 2, 0.0}}},
                   "finite"},
        BadCommand{"RefineNoRadius", RefineMesh{{{Vec3(0.0, 0.0, 0.2)}, {0.0, 2, 0.0}}}, "radius"},
        BadCommand{"RefineTooFar", RefineMesh{{{Vec3(0.0, 0.0, 0.2)}, {0.1, 13, 0.0}}},
                   "generations: expected 0 to 12"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Command, GravityActsFromTheNextStep) {
  Simulation simulation = simulationOf();
  ASSERT_TRUE(simulation.apply(SetGravity{Vec3::Zero()}).success);
  const double height = simulation.state().x[40].z();
  run(simulation, 10);
  EXPECT_EQ(simulation.state().x[40].z(), height);
}

TEST(Command, PhaseJumpsAndActsAtOnce) {
  Simulation simulation = simulationOf();
  run(simulation, 2);
  ASSERT_TRUE(simulation.apply(SetPhase{"notch"}).success);
  EXPECT_GT(simulation.broken().cut, 0) << "the notch of that phase";
  EXPECT_EQ(simulation.broken().torn, 0);
  ASSERT_EQ(simulation.script().history().size(), 2U);
  EXPECT_EQ(simulation.script().history()[1].name, "notch");
}

TEST(Command, ClampGoesWhereItIsTold) {
  Simulation simulation = simulationOf();
  const Vec3 target(0.3, 0.1, 0.5);
  const Quat almost(1.0005, 0.0, 0.0, 0.0);  // as four digits leave it
  ASSERT_TRUE(simulation.apply(SetClampTarget{"left", poseOf(target, almost)}).success);
  EXPECT_NEAR(simulation.clamps()[0].target().orientation.norm(), 1.0, 1e-15);
  run(simulation, 300);
  EXPECT_TRUE(simulation.clamps()[0].atTarget());
  EXPECT_NEAR((simulation.clamps()[0].pose().position - target).norm(), 0.0, 1e-6);
}

TEST(Command, APatchOutOfReachIsNotGrasped) {
  Simulation simulation = simulationOf({"gravity=[0,0,0]", "clamps.left.pose={position: [0,0,3]}"});
  const std::uint64_t before = stateHash(simulation.model(), simulation.state());
  for (const Command& command :
       {Command(SetGrasp{"left", true}), Command(SetGapWidth{"left", 0.0})}) {
    const CommandResult result = simulation.apply(command);
    EXPECT_FALSE(result.success);
    EXPECT_THAT(result.message, testing::HasSubstr("m from its patch, and reaches 0.142 m"));
    EXPECT_THAT(result.message, testing::HasSubstr("attach"));
  }
  EXPECT_EQ(simulation.clamps()[0].state(), ClampState::kOpen);
  EXPECT_EQ(stateHash(simulation.model(), simulation.state()), before);
  EXPECT_TRUE(simulation.apply(SetGrasp{"left", false}).success);
}

TEST(Command, GraspTakesThePatch) {
  Simulation simulation = simulationOf({"gravity=[0,0,0]"});
  ASSERT_TRUE(simulation.apply(SetGrasp{"left", true}).success);
  run(simulation, 100);
  EXPECT_EQ(simulation.clamps()[0].state(), ClampState::kClosed);
  EXPECT_EQ(simulation.clamps()[0].held().size(), 9U) << "(2 R + 1)^2 with R = 1";
  ASSERT_TRUE(simulation.apply(SetGrasp{"left", false}).success);
  EXPECT_TRUE(simulation.clamps()[0].held().empty());
}

TEST(Command, TearingIsSwitched) {
  Simulation simulation = simulationOf({"gravity=[0,0,0]", "cloth.velocity=[30,0,0]"});
  ASSERT_TRUE(simulation.apply(SetTearing{false, {1.5, 1.5, 1.5}}).success);
  run(simulation, 5);
  EXPECT_EQ(simulation.broken().torn, 0) << "off";
  ASSERT_TRUE(simulation.apply(SetTearing{true, {1.0001, 1.0001, 1.0001}}).success);
  run(simulation, 5);
  EXPECT_GT(simulation.broken().torn, 0) << "the pinned corner is torn at";
}

TEST(Command, ObstacleIsMoved) {
  Simulation simulation = simulationOf();
  ASSERT_TRUE(simulation.apply(MoveObstacle{"ball", poseOf({1, 1, 1}), Vec3(0, 0, 2)}).success);
  run(simulation, 10);
  const Vec3 now = simulation.colliders().all()[0].poseAt(simulation.time()).position;
  EXPECT_NEAR((now - Vec3(1.0, 1.0, 1.2)).norm(), 0.0, 1e-12);
}

TEST(Command, ResetGoesBackToTheStart) {
  Simulation simulation = simulationOf();
  const std::uint64_t start = hashOf(simulation);
  run(simulation, 30);
  ASSERT_GT(simulation.broken().total, 0);
  ASSERT_TRUE(simulation.apply(Reset{}).success);
  EXPECT_EQ(hashOf(simulation), start);
  EXPECT_EQ(simulation.broken().total, 0);
  EXPECT_EQ(simulation.stepCount(), 0U);
  EXPECT_TRUE(simulation.script().history().empty());
  EXPECT_TRUE(simulation.takeEvents().empty());
  EXPECT_EQ(simulation.snapshot()->topology->revision, 0U);
}

// ---- events and snapshots

TEST(Simulation, EveryFailureIsCountedOnce) {
  Simulation simulation = simulationOf();
  const int springs = simulation.model().springs.count();
  run(simulation, 15);
  const BrokenCounts& broken = simulation.broken();
  const std::vector<FailureEvent> events = simulation.takeEvents();
  EXPECT_EQ(broken.total, static_cast<int>(events.size()));
  EXPECT_EQ(broken.total, broken.byKind[0] + broken.byKind[1] + broken.byKind[2]);
  EXPECT_EQ(broken.total, broken.torn + broken.cut);
  EXPECT_GT(broken.cut, 0);
  EXPECT_LT(broken.total, springs);
  EXPECT_TRUE(simulation.takeEvents().empty()) << "taken";
  EXPECT_EQ(simulation.broken().total, broken.total) << "but still counted";
}

TEST(Snapshot, ShowsTheSimulation) {
  Simulation simulation = simulationOf({"cloth.bending=springs"});
  run(simulation, 3);
  const auto shot = simulation.snapshot();
  EXPECT_EQ(shot->time, simulation.time());
  EXPECT_EQ(shot->step, 3U);
  EXPECT_EQ(shot->positions, simulation.state().x.values());
  EXPECT_EQ(shot->phase, "fall");
  EXPECT_EQ(shot->particles, 63);
  EXPECT_EQ(shot->faces, 2 * 8 * 6);
  EXPECT_THAT(shot->springs, ElementsAre(8 * 7 + 9 * 6, 2 * 8 * 6, 7 * 7 + 9 * 5));
  EXPECT_EQ(shot->clamps.size(), 2U);
  EXPECT_EQ(shot->obstacles.size(), 2U);
  ASSERT_EQ(shot->figures->pieces.size(), 1U);
  EXPECT_NEAR(shot->figures->pieces[0].restArea, 0.12, 1e-15);
  EXPECT_NEAR(shot->figures->restArea, 0.12, 1e-15);
  EXPECT_FALSE(shot->failed);
  EXPECT_EQ(shot->topology->strainLines.size(), 8U * 7 + 9 * 6 + 2 * 8 * 6) << "no bend springs";
  EXPECT_TRUE(shot->topology->tornEdges.empty());
  EXPECT_FALSE(simulation.snapshot(Detail::kShape)->figures) << "not asked for";
}

TEST(Snapshot, SharesTheTopologyUntilItChanges) {
  Simulation simulation = simulationOf();
  run(simulation, 2);
  const auto first = simulation.snapshot();
  run(simulation, 2);
  const auto second = simulation.snapshot();
  EXPECT_EQ(first->topology, second->topology);
  EXPECT_NE(first->positions, second->positions);
  run(simulation, 10);
  const auto torn = simulation.snapshot();
  EXPECT_NE(torn->topology, first->topology);
  EXPECT_GT(torn->topology->revision, first->topology->revision);
  // The notch goes up to v = 0.11 at u = 0.225: its flanks lie on it, and are as long.
  double length = 0.0;
  for (const auto& edge : torn->topology->tornEdges) {
    const Vec2& a = torn->topology->material[edge[0]];
    const Vec2& b = torn->topology->material[edge[1]];
    EXPECT_NEAR(a.x(), 0.225, 1e-12);
    EXPECT_NEAR(b.x(), 0.225, 1e-12);
    length += (b - a).norm();
  }
  EXPECT_NEAR(length, 2 * 0.11, 1e-12);
  EXPECT_EQ(first->topology->revision, 0U) << "what was given out does not change";
}

// ---- failure

TEST(Simulation, StopsAtTheLastGoodStateIfTheMethodDiverges) {
  // Ten times the step at which symplectic Euler is stable.
  Simulation simulation =
      simulationOf({"solver={method: symplectic_euler, dt: 0.01, substeps: 3}",
                    "cloth.velocity=[1,2,3]", "clamps={}", "tearing={}", "phases=[]"});
  for (int k = 0; k < 2000 && !simulation.failed(); ++k) simulation.step();
  ASSERT_TRUE(simulation.failed());
  EXPECT_THAT(simulation.failure(), HasSubstr("symplectic_euler diverged in the step from t = "));
  EXPECT_TRUE(isFinite(simulation.state()));
  const std::uint64_t hash = hashOf(simulation);
  const std::uint64_t steps = simulation.stepCount();
  run(simulation, 3);
  EXPECT_EQ(hashOf(simulation), hash);
  EXPECT_EQ(simulation.stepCount(), steps);
  const auto json = nlohmann::json::parse(summaryJson(simulation, startRecord(simulation), 1.0));
  EXPECT_EQ(json["status"], "failed");
  EXPECT_EQ(json["finite"], true) << "the state is the last good one";
  EXPECT_TRUE(simulation.apply(Reset{}).success);
  EXPECT_FALSE(simulation.failed());
}

TEST(Simulation, FailsIfAPhaseDoesNotEndInTime) {
  Simulation simulation =
      simulationOf({"phases=[{name: wait, until: {pieces: 2}, timeout: 0.05}]"});
  run(simulation, 20);
  EXPECT_TRUE(simulation.failed());
  EXPECT_EQ(
      simulation.failure(),
      "phase 'wait' did not end within its time-out of 0.05 s; it lasts until the cloth is in 2 "
      "pieces");
}

// ---- summary

using Json = nlohmann::json;

std::vector<std::string> keysOf(const Json& json) {
  std::vector<std::string> keys;
  for (const auto& item : json.items()) keys.push_back(item.key());
  return keys;
}

TEST(Summary, HasEveryKeyOfTheContract) {
  Simulation simulation = simulationOf();
  const RunRecord start = startRecord(simulation);
  run(simulation, 30);
  simulation.observeMaxStretch();
  const Json json = Json::parse(summaryJson(simulation, start, 0.5));
  EXPECT_THAT(keysOf(json),
              testing::IsSupersetOf(
                  {"scene",      "solver",       "method_params",   "particles",
                   "faces",      "springs",      "broken",          "pieces",
                   "mass_kg",    "rest_area_m2", "initial_mass_kg", "initial_rest_area_m2",
                   "phases",     "sim_time_s",   "wall_time_s",     "real_time_factor",
                   "max_strain", "energy_j",     "state_hash",      "finite",
                   "separation", "peak_force_n", "clamps"}));
  EXPECT_THAT(keysOf(json["springs"]),
              testing::UnorderedElementsAre("active", "structural", "shear", "bend"));
  EXPECT_THAT(keysOf(json["broken"]),
              testing::UnorderedElementsAre("total", "structural", "shear", "bend", "torn", "cut"));
  EXPECT_THAT(keysOf(json["energy_j"]),
              testing::UnorderedElementsAre("kinetic", "elastic", "gravity"));
  EXPECT_EQ(json["scene"], "bench");
  EXPECT_EQ(json["solver"], "xpbd");
  EXPECT_EQ(json["method_params"]["substeps"], 5);
  EXPECT_EQ(json["faces"], simulation.model().mesh.faceCount());
  EXPECT_GT(json["faces"], 96) << "the notch splits faces";
  ASSERT_EQ(json["piece_list"].size(), 1U);
  EXPECT_THAT(
      keysOf(json["piece_list"][0]),
      testing::UnorderedElementsAre("faces", "mass_kg", "rest_area_m2", "centre_of_mass_m"));
  EXPECT_EQ(json["piece_list"][0]["faces"], json["faces"]);
  EXPECT_EQ(json["dropped"]["count"], 0);
  EXPECT_GT(json["shortest_edge_m"], 0.0);
  EXPECT_GT(json["stable_step_s"], 0.0);
  EXPECT_EQ(json["particles"], simulation.model().particleCount());
  EXPECT_EQ(json["springs"]["active"], simulation.model().springs.count());
  EXPECT_EQ(json["broken"]["total"], simulation.broken().total);
  EXPECT_NEAR(json["mass_kg"].get<double>(), start.initialMass, 1e-12 * start.initialMass);
  EXPECT_NEAR(json["rest_area_m2"].get<double>(), 0.12, 1e-15);
  EXPECT_NEAR(json["sim_time_s"].get<double>(), 0.3, 1e-12);
  EXPECT_NEAR(json["real_time_factor"].get<double>(), 0.6, 1e-12);
  EXPECT_EQ(json["finite"], true);
  EXPECT_GT(json["max_strain"].get<double>(), 0.0);
  ASSERT_EQ(json["phases"].size(), 3U);
  EXPECT_EQ(json["phases"][0]["name"], "fall");
  EXPECT_EQ(json["phases"][0]["start_s"], 0.0);
  EXPECT_NEAR(json["phases"][0]["end_s"].get<double>(), 0.1, 1e-9);
  EXPECT_TRUE(json["phases"][2]["end_s"].is_null()) << "still running";
  const std::string hash = json["state_hash"];
  EXPECT_EQ(hash.size(), 16U);
  EXPECT_EQ(std::stoull(hash, nullptr, 16), hashOf(simulation));
}

TEST(Summary, IsValidJsonWhateverTheNumbers) {
  const Simulation simulation = simulationOf();
  RunRecord record;
  record.initialMass = kNan;
  record.initialRestArea = kInf;
  record.peaks = {{"left", kNan, 0.0}};
  const Json json = Json::parse(summaryJson(simulation, record, 0.0));
  EXPECT_TRUE(json["clamps"]["left"]["peak_force_n"].is_null());
  EXPECT_TRUE(json["initial_mass_kg"].is_null());
  EXPECT_TRUE(json["initial_rest_area_m2"].is_null());
  EXPECT_TRUE(json["real_time_factor"].is_null()) << "0/0";
}

}  // namespace
}  // namespace cloth_sim
