/// \file Grips of limited force: they hold up to the limit, slip beyond it, and report it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Kind = GripEvent::Kind;

constexpr double kMass = 0.2;             // of the cloth [kg]
constexpr double kWeight = kMass * 9.81;  // [N]
constexpr double kHalfPlate = 0.1;        // along the pull [m]
constexpr double kDt = 1.0 / 60.0;        // [s]

/// A cloth of 0.2 kg that hangs by a clamp as wide as the cloth, whose plates reach 0.1 m down.
const char* const kScene = R"(
cloth:
  size: [0.4, 0.5]
  particles: [9, 21]
  pose: {position: [0, 0, 0.75], rpy: [1.5707963267948966, 0, 0]}
  fabric: {areal_density: 1.0, damping: 0.01}
solver: {method: xpbd, substeps: 20}
clamps:
  hand:
    pose: {position: [0, 0, 1.0], rpy: [1.5707963267948966, 0, 0]}
    plate_size: [0.5, 0.2]
    closing_speed: 10.0
    max_speed: 1.0
    max_acceleration: 10.0
phases:
  - {name: hold, clamps: {hand: {grasp: true}}}
)";

Simulation hanging(const std::vector<std::string>& overrides = {}) {
  Simulation simulation(parseScene(kScene, "hand.yaml", overrides));
  for (int k = 0; k < 240; ++k) simulation.step();  // the jolt of the start has died away
  return simulation;
}

void limit(Simulation& simulation, double force) {
  ASSERT_TRUE(simulation.apply(SetGripForce{"hand", force}).success);
}

Vec3 meanVelocity(const Simulation& simulation) {
  Vec3 momentum = Vec3::Zero();
  const Model& model = simulation.model();
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    momentum += model.mass[v] * simulation.state().v[v];
  }
  return momentum / totalMass(model);
}

std::vector<Kind> kinds(const std::vector<GripEvent>& events) {
  std::vector<Kind> result;
  for (const GripEvent& event : events) result.push_back(event.kind);
  return result;
}

TEST(Grip, BearsTheWeightOfWhatItHolds) {
  Simulation simulation = hanging();
  EXPECT_NEAR(totalMass(simulation.model()), kMass, 1e-12);
  EXPECT_NEAR(simulation.clamps()[0].wrench().force.z(), -kWeight, 0.005 * kWeight);
  EXPECT_NEAR(simulation.clamps()[0].wrench().force.head<2>().norm(), 0.0, 0.005 * kWeight);
}

TEST(Grip, ReportsWhatItGrasped) {
  Simulation simulation = hanging();
  const std::vector<GripEvent> events = simulation.takeGripEvents();
  ASSERT_THAT(kinds(events), ElementsAre(Kind::kClosed));
  // The rows at v = 0.5, 0.475, ... 0.4 m, nine particles in each.
  EXPECT_EQ(events[0].contents.held, 5 * 9);
  EXPECT_NEAR(events[0].contents.area, 0.4 * (0.1 + 0.5 * 0.025), 1e-3);
  EXPECT_EQ(events[0].contents.onObstacle, 0);
  EXPECT_EQ(events[0].clamp, "hand");
}

TEST(Grip, CountsWhatLiesOnAnObstacle) {
  Simulation simulation =
      hanging({"obstacles={wall: {type: plane, rpy: [-1.5707963267948966, 0, 0], "
               "position: [0, -0.0001, 0]}}"});
  const std::vector<GripEvent> events = simulation.takeGripEvents();
  ASSERT_THAT(kinds(events), ElementsAre(Kind::kClosed));
  EXPECT_EQ(events[0].contents.onObstacle, 5 * 9);
}

TEST(Grip, HoldsWithinItsForce) {
  Simulation simulation = hanging();
  simulation.takeGripEvents();
  limit(simulation, 1.05 * kWeight);
  for (int k = 0; k < 60; ++k) simulation.step();
  EXPECT_FALSE(simulation.clamps()[0].isSlipping());
  EXPECT_TRUE(simulation.takeGripEvents().empty());
  EXPECT_NEAR(simulation.clamps()[0].wrench().force.norm(), kWeight, 0.005 * kWeight);
}

/// The cloth falls with g - F / m as long as a part of it is between the plates.
TEST(Grip, BeyondItsForceTheClothSlidesAsDryFrictionSays) {
  constexpr double kForce = 1.5;  // [N]
  const double acceleration = 9.81 - kForce / kMass;
  Simulation simulation = hanging();
  simulation.takeGripEvents();
  limit(simulation, kForce);
  double slid = 0.0;
  for (int k = 1; slid < 0.8 * kHalfPlate; ++k) {
    simulation.step();
    const double time = k * kDt;
    EXPECT_NEAR(meanVelocity(simulation).z(), -acceleration * time, 0.01 * acceleration * time);
    EXPECT_NEAR(simulation.clamps()[0].wrench().force.norm(), kForce, 1e-9);
    slid = 0.5 * acceleration * time * time;
  }
  EXPECT_NEAR(simulation.clamps()[0].slipped(), slid, 0.1 * kHalfPlate);
  ASSERT_THAT(kinds(simulation.takeGripEvents()), ElementsAre(Kind::kSlipping));
}

TEST(Grip, LetsGoOfWhatHasSlidOut) {
  Simulation simulation = hanging();
  simulation.takeGripEvents();
  limit(simulation, 1.0);
  for (int k = 0; k < 60; ++k) simulation.step();
  EXPECT_TRUE(simulation.clamps()[0].held().empty());
  EXPECT_FALSE(simulation.clamps()[0].isSlipping());
  EXPECT_EQ(simulation.clamps()[0].wrench().force, Vec3::Zero());
  const std::vector<GripEvent> events = simulation.takeGripEvents();
  ASSERT_THAT(kinds(events), ElementsAre(Kind::kSlipping, Kind::kLost));
  EXPECT_GE(events[1].slipped, 0.9 * kHalfPlate);
}

/// A jerk upwards at 10 m/s^2 takes 4 N, of a grip that has 3 N; then the grip holds again.
TEST(Grip, SlipsInAJerkAndHoldsAgain) {
  constexpr double kForce = 3.0;
  Simulation simulation = hanging({"clamps.hand.grip_force=3.0"});
  simulation.takeGripEvents();
  ASSERT_FALSE(simulation.clamps()[0].held().empty());
  Pose up = simulation.clamps()[0].pose();
  up.position.z() += 1.0;
  ASSERT_TRUE(simulation.apply(SetClampTarget{"hand", up}).success);
  double most = 0.0;
  for (int k = 0; k < 54; ++k) {
    simulation.step();
    most = std::max(most, simulation.clamps()[0].wrench().force.norm());
  }
  EXPECT_LE(most, kForce * (1.0 + 1e-12));
  EXPECT_GE(most, kForce * (1.0 - 1e-12));
  const std::vector<Kind> seen = kinds(simulation.takeGripEvents());
  ASSERT_GE(seen.size(), 2U);
  EXPECT_EQ(seen.front(), Kind::kSlipping);
  EXPECT_EQ(seen.back(), Kind::kHolding);
  EXPECT_FALSE(simulation.clamps()[0].isSlipping());
  EXPECT_GT(simulation.clamps()[0].slipped(), 0.0);
}

TEST(Grip, ALimitThatIsNeverReachedChangesNoBit) {
  Simulation unlimited = hanging();
  Simulation limited = hanging({"clamps.hand.grip_force=1000.0"});
  EXPECT_EQ(stateHash(unlimited.model(), unlimited.state()),
            stateHash(limited.model(), limited.state()));
}

TEST(Grip, RefusesForcesThatAreNone) {
  Simulation simulation(parseScene(kScene, "hand.yaml", {}));
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(simulation.apply(SetGripForce{"hand", bad}).success);
  }
  EXPECT_THAT(simulation.apply(SetGripForce{"foot", 1.0}).message, HasSubstr("unknown clamp"));
  EXPECT_TRUE(simulation.apply(SetGripForce{"hand", std::nullopt}).success);
}

// ---- clamps that come and go

TEST(ClampSet, GrowsAndShrinksWhileItRuns) {
  Simulation simulation(parseScene(kScene, "hand.yaml", {}));
  ClampSpec spec;
  spec.name = "second";
  spec.pose.position = Vec3(0.0, 0.0, 0.5);
  EXPECT_TRUE(simulation.apply(CreateClamp{spec}).success);
  EXPECT_THAT(simulation.apply(CreateClamp{spec}).message, HasSubstr("already"));
  ASSERT_EQ(simulation.clamps().size(), 2U);
  EXPECT_TRUE(simulation.apply(SetGrasp{"second", true}).success);
  for (int k = 0; k < 60; ++k) simulation.step();
  EXPECT_FALSE(simulation.clamps()[1].held().empty());
  EXPECT_TRUE(simulation.apply(DeleteClamp{"second"}).success);
  EXPECT_EQ(simulation.clamps().size(), 1U);
  EXPECT_THAT(simulation.apply(DeleteClamp{"second"}).message, HasSubstr("unknown clamp"));
  spec.gapOpen = 0.0;
  EXPECT_THAT(simulation.apply(CreateClamp{spec}).message, HasSubstr("gap"));
  EXPECT_TRUE(simulation.apply(DeleteClamp{"hand"}).success);
  EXPECT_TRUE(simulation.apply(Reset{}).success);
  EXPECT_EQ(simulation.clamps().size(), 1U) << "the scene's";
}

TEST(ClampSet, ARemovedClampLetsGo) {
  Simulation simulation = hanging();
  ASSERT_TRUE(simulation.apply(DeleteClamp{"hand"}).success);
  simulation.step();
  EXPECT_NEAR(meanVelocity(simulation).z(), -9.81 * kDt, 0.01 * 9.81 * kDt);
}

// ---- targets that move

TEST(GuidedClamp, GoesAlongWithoutLagAndStopsAtTheHorizon) {
  Simulation simulation(parseScene(kScene, "hand.yaml", {}));
  MovingPose target{simulation.clamps()[0].pose(), Vec3(0.2, 0.0, 0.1), Vec3(0.0, 0.0, 0.3), 2.0};
  ASSERT_TRUE(simulation.apply(GuideClamp{"hand", target}).success);
  for (int k = 0; k < 60; ++k) simulation.step();
  MovingPose expected = target;
  expected.advance(1.0);
  const Clamp& clamp = simulation.clamps()[0];
  EXPECT_LE((clamp.pose().position - expected.pose.position).norm(), 1e-9);
  EXPECT_LE(clamp.pose().orientation.angularDistance(expected.pose.orientation), 1e-9);
  EXPECT_LE((clamp.linearVelocity() - target.linear).norm(), 1e-9);
  for (int k = 0; k < 90; ++k) simulation.step();
  expected.advance(1.5);
  EXPECT_LE((clamp.pose().position - expected.pose.position).norm(), 1e-6);
  EXPECT_TRUE(clamp.atTarget());
}

TEST(GuidedClamp, KeepsItsLimits) {
  Simulation simulation(parseScene(kScene, "hand.yaml", {}));
  MovingPose target{simulation.clamps()[0].pose(), Vec3(5.0, 0.0, 0.0), Vec3::Zero(), 10.0};
  ASSERT_TRUE(simulation.apply(GuideClamp{"hand", target}).success);
  Vec3 before = Vec3::Zero();
  for (int k = 0; k < 120; ++k) {
    simulation.step();
    const Vec3 velocity = simulation.clamps()[0].linearVelocity();
    EXPECT_LE(velocity.norm(), 1.0 + 1e-9);
    EXPECT_LE((velocity - before).norm(), 10.0 * kDt + 1e-9);
    before = velocity;
  }
  target.linear.x() = std::nan("");
  EXPECT_FALSE(simulation.apply(GuideClamp{"hand", target}).success);
}

TEST(GuidedObstacle, IsWhereItsTargetIsAtTheEndOfEveryStep) {
  Simulation simulation(
      parseScene(kScene, "hand.yaml", {"obstacles={ball: {type: sphere, radius: 0.1}}"}));
  MovingPose target;
  target.linear = Vec3(0.5, 0.0, 0.0);
  target.horizon = 0.5;
  ASSERT_TRUE(simulation.apply(GuideObstacle{"ball", target}).success);
  for (int k = 1; k <= 60; ++k) {
    simulation.step();
    const Collider& ball = simulation.colliders().all()[0];
    EXPECT_NEAR(ball.poseAt(simulation.time()).position.x(), 0.5 * std::min(0.5, k * kDt), 1e-12);
  }
  target.pose.position.x() = 100.0;
  ASSERT_TRUE(simulation.apply(GuideObstacle{"ball", target}).success);
  simulation.step();
  EXPECT_EQ(simulation.colliders().all()[0].obstacle().velocity, Vec3::Zero()) << "a jump";
  EXPECT_THAT(simulation.apply(GuideObstacle{"bowl", target}).message, HasSubstr("known: ball"));
}

TEST(GuidedObstacle, IsPlacedWhereItsTargetIsAtFirst) {
  // From one side of the cloth to the other: swept, the board would take the cloth along.
  Simulation simulation(parseScene(kScene, "hand.yaml",
                                   {"obstacles={board: {type: box, size: [0.4, 0.02, 0.4],"
                                    " position: [0, 0.05, 0.75]}}",
                                    "gravity=[0, 0, 0]"}));
  MovingPose target;
  target.pose.position = Vec3(0.0, -0.05, 0.75);
  ASSERT_TRUE(simulation.apply(GuideObstacle{"board", target}).success);
  simulation.step();
  const Collider& board = simulation.colliders().all()[0];
  EXPECT_EQ(board.poseAt(simulation.time()).position, target.pose.position);
  for (const Vec3& x : simulation.state().x) EXPECT_NEAR(x.y(), 0.0, 1e-6);

  target.pose.position.y() = -0.03;
  ASSERT_TRUE(simulation.apply(GuideObstacle{"board", target}).success);
  simulation.step();
  EXPECT_NEAR(board.obstacle().velocity.y(), 0.02 / kDt, 1e-9) << "afterwards it moves";
}

/// Cloth above cloth that is held all over; a clamp goes down with the upper one.
const char* const kLayers = R"(
cloth:
  - {name: lower, size: [0.1, 0.1], particles: [7, 7], fabric: cotton, thickness: 0.001}
  - {name: upper, size: [0.1, 0.1], particles: [7, 7], fabric: cotton, thickness: 0.001,
     pose: {position: [0, 0, 0.02]}}
self_contact: true
gravity: [0, 0, 0]
drag: 2
solver: {method: line_xpbd, error: 0.01}
clamps:
  floor: {patch: {cloth: lower, particle: [3, 3], radius: 6}, pose: {position: [0, 0, 0]}}
  hand: {patch: {cloth: upper, particle: [3, 3], radius: 1}, pose: {position: [0, 0, 0.02]}}
phases:
  - name: grasp
    clamps: {all: {grasp: true}}
    until: {clamps: closed}
    timeout: 2
  - name: down
    clamps: {hand: {move_by: [0, 0, -0.03], speed: 0.2}}
    timeout: 0.2
  - name: up
    clamps: {hand: {move_by: [0, 0, 0.03], speed: 0.2}}
    until: {clamps: at_target}
    timeout: 2
)";

TEST(Grip, ReportsOnceThatALayerBlocksItAndOnceThatItIsFree) {
  Simulation simulation(parseScene(kLayers, "layers.yaml", {}));
  std::vector<Kind> ofHand;
  while (simulation.script().status() != ScriptStatus::kDone) {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
    for (const GripEvent& event : simulation.takeGripEvents()) {
      if (event.clamp == "hand") ofHand.push_back(event.kind);
    }
  }
  EXPECT_THAT(ofHand, ElementsAre(Kind::kClosed, Kind::kBlocked, Kind::kFreed));
}

}  // namespace
}  // namespace cloth_sim
