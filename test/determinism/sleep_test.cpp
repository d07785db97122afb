/// \file A cloth at rest falls asleep, and wakes when something touches it. It then continues with
/// the same bits as a cloth that stayed awake, at any number of threads and from a saved state.

#include "cloth_sim/sim/sleep.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "cloth_sim/sim/summary.h"
#include "cloth_sim/threads/thread_limit.h"
#include "support/hash.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

/// A towel that hangs from two pins and a clamp onto a ball. The drag is large, so that it comes to
/// rest in 3 s.
const char* const kTowel = R"(
cloth:
  size: [0.2, 0.2]
  particles: [10, 10]
  pose: {position: [0, 0, 0.3], rpy: [1.2, 0, 0]}
  fabric: silk
  pins: [corner_01, corner_11]
drag: 20
obstacles:
  ball: {type: sphere, radius: 0.05, position: [0, -0.1, 0.2]}
clamps:
  hand: {patch: {particle: [0, 0], radius: 1}, gap_open: 0.03, closing_speed: 1}
tearing: {ratio: 3}
)";
const char* const kGrasp =
    "phases: [{name: hold, clamps: {hand: {attach: true, grasp: true, speed: 1}}}]";

constexpr double kDt = 0.01;  ///< of the scenes below [s]

Scene towel(const std::string& method = "xpbd", const std::string& phases = kGrasp) {
  const bool limited = std::isfinite(findSolver(method).stabilityLimit);
  const std::string substeps = limited ? "200" : "5";
  return parseScene(kTowel + phases, "towel.yaml",
                    {"solver={method: " + method + ", dt: 0.01, substeps: " + substeps + "}"});
}

Scene awake(Scene scene) {
  scene.solver.sleep.reset();
  return scene;
}

std::uint64_t hashOf(const Simulation& simulation) {
  return stateHash(simulation.model(), simulation.state());
}

void run(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.step();
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
}

constexpr int kMost = 800;  ///< steps in which the towel comes to rest

/// Steps the simulation until it is asleep. \return the number of steps.
int runToSleep(Simulation& simulation, int most = kMost) {
  for (int k = 0; k < most; ++k) {
    if (simulation.isAsleep()) return k;
    simulation.step();
  }
  EXPECT_TRUE(simulation.isAsleep()) << "it was to come to rest";
  return most;
}

/// A cloth with the same state, time and history, which never sleeps.
Simulation awakeTwin(const Simulation& sleeper) {
  Simulation twin(awake(sleeper.scene()));
  twin.load(sleeper.save());
  EXPECT_FALSE(twin.isAsleep());
  return twin;
}

void expectSameSteps(Simulation& a, Simulation& b, int steps) {
  for (int k = 0; k < steps; ++k) {
    a.step();
    b.step();
    ASSERT_EQ(hashOf(a), hashOf(b)) << "step " << k;
    for (std::size_t c = 0; c < a.clamps().size(); ++c) {
      ASSERT_EQ(a.clamps()[c].wrench().force, b.clamps()[c].wrench().force) << "step " << k;
    }
  }
}

// ---- asleep ------------------------------------------------------------------------------------

TEST(Sleep, OnlyLetsTimeGoOn) {
  Simulation simulation(towel());
  runToSleep(simulation);
  for (const Vec3& v : simulation.state().v) ASSERT_EQ(v, Vec3(Vec3::Zero()));
  ASSERT_FALSE(simulation.contacts().empty());
  const std::vector<Vec3> before = simulation.state().x.values();
  const Vec3 pull = simulation.clamps()[0].wrench().force;
  const Vec3 impulse = simulation.contacts().candidates[0].impulse.linear;
  EXPECT_GT(pull.norm(), 0.0);
  double time = simulation.time();
  const std::uint64_t steps = simulation.stepCount();
  for (int k = 0; k < 100; ++k) {
    simulation.step();
    time += kDt;
    ASSERT_EQ(simulation.time(), time);
  }
  EXPECT_EQ(simulation.stepCount(), steps + 100);
  EXPECT_EQ(simulation.state().x.values(), before);
  EXPECT_EQ(simulation.clamps()[0].wrench().force, pull);
  EXPECT_EQ(simulation.contacts().candidates[0].impulse.linear, impulse);
  EXPECT_NEAR(simulation.timeAsleep(), 1.0, 1e-9);
}

TEST(Sleep, ComesAfterRestOfTheWholeTime) {
  Simulation simulation(towel());
  int slow = 0;  // steps in a row
  while (!simulation.isAsleep() && simulation.stepCount() < kMost) {
    const std::vector<Vec3> before = simulation.state().x.values();
    simulation.step();
    if (simulation.isAsleep()) break;
    const double farthest = testing_support::farthestMove(before, simulation.state());
    slow = farthest < 1e-3 * kDt ? slow + 1 : 0;
    ASSERT_LT(slow, 50) << "at t = " << simulation.time();
  }
  EXPECT_EQ(slow, 49) << "the 50th makes half a second";
}

TEST(Sleep, CanBeTurnedOff) {
  Simulation simulation(awake(towel()));
  run(simulation, kMost);
  EXPECT_FALSE(simulation.isAsleep());
  EXPECT_EQ(simulation.timeAsleep(), 0.0);
}

TEST(Sleep, LeavesTheForceOnAClampAsItWas) {
  Simulation sleeper(towel());
  Simulation watcher(awake(towel()));
  runToSleep(sleeper);
  run(watcher, 2 * kMost);
  const double force = watcher.clamps()[0].wrench().force.norm();
  EXPECT_GT(force, 1e-3);
  const Vec3 off = sleeper.clamps()[0].wrench().force - watcher.clamps()[0].wrench().force;
  EXPECT_LT(off.norm(), 1e-5 * force);  // measured: 1.4e-6
}

TEST(Sleep, LargestStretchIsKnownAsleep) {
  Simulation simulation(towel());
  runToSleep(simulation);
  const double first = simulation.observeMaxStretch();
  simulation.step();
  EXPECT_EQ(simulation.observeMaxStretch(), first);
  EXPECT_EQ(first, maxStretch(simulation.model(), simulation.state()));
  ASSERT_TRUE(simulation.apply(SetGravity{Vec3(0.0, 0.0, -30.0)}).success);
  run(simulation, 10);
  EXPECT_EQ(simulation.observeMaxStretch(), maxStretch(simulation.model(), simulation.state()));
  runToSleep(simulation);
  EXPECT_EQ(simulation.observeMaxStretch(), maxStretch(simulation.model(), simulation.state()));
  EXPECT_NE(simulation.observeMaxStretch(), first);
}

TEST(Sleep, IsToldInTheSummary) {
  Simulation simulation(towel());
  const RunRecord record = startRecord(simulation);
  runToSleep(simulation);
  run(simulation, 50);
  EXPECT_NE(summaryJson(simulation, record, 1.0).find("\"asleep_s\": 0.5"), std::string::npos)
      << summaryJson(simulation, record, 1.0);
}

TEST(Sleep, EndsWithAReset) {
  Simulation simulation(towel());
  const int steps = runToSleep(simulation);
  run(simulation, 10);
  ASSERT_TRUE(simulation.apply(Reset{}).success);
  EXPECT_FALSE(simulation.isAsleep());
  EXPECT_EQ(simulation.timeAsleep(), 0.0);
  EXPECT_EQ(runToSleep(simulation), steps);
}

// ---- staying awake -----------------------------------------------------------------------------

/// A stiff sheet of 1 m on a hinge, released 0.1 rad from the vertical. At its turning points its
/// speed is zero, but its acceleration is 1 m/s^2.
Simulation pendulum(const SleepSettings& sleep) {
  Scene scene = parseScene(R"(
cloth:
  size: [1, 1]
  particles: [2, 2]
  pose: {position: [0, 0, 0], rpy: [1.4707963267948966, 0, 0]}
  fabric: cotton
  pins: [last_row]
solver: {method: verlet, dt: 0.01, substeps: 50}
)",
                           "pendulum.yaml");
  scene.solver.sleep = sleep;
  return Simulation(scene);
}

TEST(Sleep, DoesNotComeWhereAPendulumTurns) {
  Simulation simulation = pendulum({0.1, 0.5});
  Sleep watch(SleepSettings{0.1, 0.5});
  int turns = 0;
  for (int k = 0; k < 1000; ++k) {
    watch.beginStep(simulation.state());
    simulation.step();
    ASSERT_FALSE(simulation.isAsleep()) << "at t = " << simulation.time();
    if (watch.isSlow(simulation.state(), kDt)) ++turns;
  }
  EXPECT_GE(turns, 5) << "it was to be slow where it turns";
  Simulation hasty = pendulum({0.1, 0.05});
  for (int k = 0; k < 1000 && !hasty.isAsleep(); ++k) hasty.step();
  EXPECT_TRUE(hasty.isAsleep()) << "the time makes the difference";
}

TEST(Sleep, DoesNotComeWhileAClampMovesHoweverSlowly) {
  Simulation simulation(towel());
  runToSleep(simulation);
  const MovingPose away{simulation.clamps()[0].pose(), Vec3(1e-4, 0.0, 0.0), Vec3::Zero(), 2.0};
  ASSERT_TRUE(simulation.apply(GuideClamp{"hand", away}).success);
  for (int k = 0; k < 200; ++k) {
    simulation.step();
    ASSERT_FALSE(simulation.isAsleep()) << "step " << k;
  }
  // Counted from the last step in which the clamp moved.
  EXPECT_LE(runToSleep(simulation), 52);
}

TEST(Sleep, DoesNotComeWhileAnObstacleMoves) {
  Simulation simulation(towel());
  runToSleep(simulation);
  const Pose far{Vec3(0.0, -0.3, 0.2)};
  ASSERT_TRUE(simulation.apply(MoveObstacle{"ball", far, Vec3(0.0, -1e-4, 0.0)}).success);
  run(simulation, kMost);
  EXPECT_FALSE(simulation.isAsleep());
  ASSERT_TRUE(simulation.apply(MoveObstacle{"ball", far, Vec3::Zero()}).success);
  EXPECT_LE(runToSleep(simulation), 50);
}

TEST(Sleep, DoesNotComeWhileAnObstacleIsGuided) {
  Simulation simulation(towel());
  runToSleep(simulation);
  const MovingPose away{Pose{Vec3(0.0, -0.3, 0.2)}, Vec3(0.0, -1e-4, 0.0), Vec3::Zero(), 2.0};
  ASSERT_TRUE(simulation.apply(GuideObstacle{"ball", away}).success);
  for (int k = 0; k < 200; ++k) {
    simulation.step();
    ASSERT_FALSE(simulation.isAsleep()) << "step " << k;
  }
  runToSleep(simulation);
}

TEST(Sleep, DoesNotComeWhileAParticleIsDragged) {
  Simulation simulation(towel());
  runToSleep(simulation);
  const Vec3 corner = simulation.state().x[9];
  const Ray ray{corner - Vec3(1.0, 0.0, 0.0), Vec3::UnitX()};
  for (int k = 0; k < kMost; ++k) {
    if (k % 50 == 0) {
      ASSERT_TRUE(simulation.apply(PullParticle{true, ray}).success);
    }
    simulation.step();
    ASSERT_FALSE(simulation.isAsleep());
  }
  run(simulation, 101);  // the drag ends by itself after a second
  runToSleep(simulation);
}

/// A notched sheet that is held stretched beyond its limit. The tear takes more than a second from
/// one edge to the next, and the cloth is at rest in between.
Scene slowTear() {
  return parseScene(R"(
cloth:
  size: [0.2, 0.2]
  particles: [9, 9]
  fabric: silk
  pins: [first_row]
gravity: [0, 0, 0]
drag: 50
solver: {method: xpbd, dt: 0.01, substeps: 5}
clamps:
  top: {patch: {particle: [4, 8], radius: 8}, gap_open: 0.03, closing_speed: 1, pose: {position: [0, 0.1, 0]}}
tearing: {enabled: false, tip_speed: 0.02}
phases:
  - {name: grasp, clamps: {top: {grasp: true}}, notch: [[0, 0.11], [0.06, 0.11]], timeout: 0.1}
  - {name: pull, clamps: {top: {move_by: [0, 0.02, 0]}}}
)",
                    "slow_tear.yaml");
}

TEST(Sleep, DoesNotComeWhileATearWaits) {
  Simulation simulation(slowTear());
  Simulation twin(awake(slowTear()));
  for (Simulation* one : {&simulation, &twin}) {
    run(*one, 100);
    ASSERT_TRUE(one->apply(SetTearing{true, {1.05, 1.05, 1.05}}).success);
  }
  Sleep watch{SleepSettings()};
  int rests = 0;  // steps in a row in which nothing moved or tore
  int longest = 0;
  for (int k = 0; k < 1500 && twin.pieces() == 1; ++k) {
    const int torn = twin.broken().torn;
    watch.beginStep(twin.state());
    simulation.step();
    twin.step();
    ASSERT_EQ(hashOf(simulation), hashOf(twin)) << "step " << k;
    const bool rest = twin.broken().torn == torn && watch.isSlow(twin.state(), kDt);
    rests = rest ? rests + 1 : 0;
    longest = std::max(longest, rests);
  }
  EXPECT_GT(longest, 60) << "it was to wait";
  EXPECT_EQ(twin.pieces(), 2) << "it was to come apart";
}

// ---- waking ------------------------------------------------------------------------------------

struct Touch {
  const char* name;
  std::function<Command(const Simulation&)> command;
};

std::ostream& operator<<(std::ostream& out, const Touch& touch) { return out << touch.name; }

Pose beside(const Pose& pose, const Vec3& by) { return {pose.position + by, pose.orientation}; }
const Collider& ballOf(const Simulation& simulation) { return simulation.colliders().all()[0]; }
Ray rayAt(const Simulation& simulation, VertexId v) {
  return {simulation.state().x[v] - Vec3(1.0, 0.0, 0.0), Vec3::UnitX()};
}

class Waking : public testing::TestWithParam<Touch> {};

/// All commands and motions that wake the cloth, each with the smallest amount that does.
INSTANTIATE_TEST_SUITE_P(
    By, Waking,
    testing::Values(
        Touch{"clamp_target",
              [](const Simulation& s) {
                return SetClampTarget{"hand", beside(s.clamps()[0].pose(), Vec3(0.0, 0.0, 1e-6))};
              }},
        Touch{"clamp_guide",
              [](const Simulation& s) {
                return GuideClamp{"hand",
                                  {s.clamps()[0].pose(), Vec3(0.0, 1e-5, 0.0), Vec3::Zero(), 0.2}};
              }},
        Touch{"clamp_turn",
              [](const Simulation& s) {
                return GuideClamp{"hand",
                                  {s.clamps()[0].pose(), Vec3::Zero(), Vec3(0.0, 1e-4, 0.0), 0.2}};
              }},
        Touch{"release",
              [](const Simulation&) {
                return SetGrasp{"hand", false};
              }},
        Touch{"gap",
              [](const Simulation&) {
                return SetGapWidth{"hand", 0.1};
              }},
        Touch{"grip_force",
              [](const Simulation&) {
                return SetGripForce{"hand", 1e-4};
              }},
        Touch{"delete_clamp", [](const Simulation&) { return DeleteClamp{"hand"}; }},
        Touch{"gravity", [](const Simulation&) { return SetGravity{Vec3(0.0, 0.0, -9.82)}; }},
        Touch{"wind",
              [](const Simulation&) {
                return SetWind{Wind{Vec3(0.0, 0.1, 0.0), 1.2, 1.0}};
              }},
        Touch{"quasi_static", [](const Simulation&) { return SetQuasiStatic{true}; }},
        Touch{"stiffness", [](const Simulation&) { return SetStiffness{1.1}; }},
        Touch{"tearing",
              [](const Simulation&) {
                return SetTearing{true, {1.0001, 9.0, 9.0}};
              }},
        Touch{"obstacle",
              [](const Simulation& s) {
                return MoveObstacle{
                    "ball", beside(ballOf(s).obstacle().pose, Vec3(0.0, 0.01, 0.01)), Vec3::Zero()};
              }},
        Touch{"moving_obstacle",
              [](const Simulation& s) {
                return MoveObstacle{"ball", ballOf(s).obstacle().pose, Vec3(0.0, 0.1, 0.1)};
              }},
        Touch{"guided_obstacle",
              [](const Simulation& s) {
                return GuideObstacle{"ball",
                                     {beside(ballOf(s).obstacle().pose, Vec3(0.0, 0.0, 1e-3)),
                                      Vec3::Zero(), Vec3::Zero(), 0.0}};
              }},
        Touch{"cut",
              [](const Simulation& s) {
                const Vec3 middle = s.state().x[44];
                return CutAlong{
                    strokeAlong({middle - Vec3(0.05, 0.0, 0.0), middle}, Vec3(0.0, 1.0, 0.0), 0.2)};
              }},
        Touch{"refine",
              [](const Simulation& s) {
                return RefineMesh{{{s.state().x[44]}, {0.02, 1, 0.0}}};
              }},
        Touch{"drag",
              [](const Simulation& s) {
                return PullParticle{true, rayAt(s, 44)};
              }}),
    [](const auto& test) { return test.param.name; });

TEST_P(Waking, IsInTheNextStepAsIfItHadBeenAwake) {
  Simulation sleeper(towel());
  runToSleep(sleeper);
  run(sleeper, 70);
  Simulation asleep(towel());
  asleep.load(sleeper.save());
  ASSERT_TRUE(asleep.isAsleep());
  Simulation twin = awakeTwin(sleeper);
  const Command command = GetParam().command(sleeper);
  ASSERT_TRUE(sleeper.apply(command).success);
  ASSERT_TRUE(twin.apply(command).success);
  EXPECT_FALSE(sleeper.isAsleep());
  expectSameSteps(sleeper, twin, 40);
  run(asleep, 40);
  EXPECT_TRUE(asleep.isAsleep());
  EXPECT_NE(hashOf(asleep), hashOf(sleeper)) << "it was to make a difference";
}

TEST(Sleep, EndsWhenAPhaseBegins) {
  const std::string phases = R"(phases:
  - {name: hold, clamps: {hand: {attach: true, grasp: true, speed: 1}}, timeout: 9}
  - {name: blow, wind: {velocity: [0, 1, 0]}, timeout: 0.2}
  - {name: calm, wind: {velocity: [0, 0, 0]}, timeout: 9})";
  Simulation sleeper(towel("xpbd", phases));
  run(sleeper, 900);
  EXPECT_TRUE(sleeper.isAsleep());
  EXPECT_EQ(sleeper.script().history().size(), 1U);
  Simulation twin = awakeTwin(sleeper);
  sleeper.step();
  twin.step();
  EXPECT_EQ(sleeper.script().history().size(), 2U);
  EXPECT_FALSE(sleeper.isAsleep());
  EXPECT_EQ(hashOf(sleeper), hashOf(twin)) << "the step in which it begins is a whole one";
  expectSameSteps(sleeper, twin, 30);
  runToSleep(sleeper);
  EXPECT_EQ(sleeper.script().history().size(), 3U);
}

TEST(Sleep, IsRestForAPhaseThatWaitsForIt) {
  const std::string phases = R"(phases:
  - {name: hold, clamps: {hand: {attach: true, grasp: true, speed: 1}}, until: {mean_speed: {below: 1.0e-9, for: 1}}, timeout: 99}
  - {name: after})";
  Simulation sleeper(towel("xpbd", phases));
  const int steps = runToSleep(sleeper);
  run(sleeper, 99);
  EXPECT_TRUE(sleeper.isAsleep());
  run(sleeper, 3);
  EXPECT_EQ(sleeper.script().history().size(), 2U) << steps;
  EXPECT_FALSE(sleeper.isAsleep());
}

TEST(Sleep, IsNotDisturbedByWhatChangesNothing) {
  Simulation simulation(towel());
  runToSleep(simulation);
  const Clamp& hand = simulation.clamps()[0];
  const Pose ball = ballOf(simulation).obstacle().pose;
  EXPECT_TRUE(simulation.apply(SetClampTarget{"hand", hand.target()}).success);
  EXPECT_TRUE(
      simulation.apply(GuideClamp{"hand", {hand.pose(), Vec3::Zero(), Vec3::Zero(), 0.5}}).success);
  EXPECT_TRUE(simulation.apply(SetGrasp{"hand", true}).success);
  EXPECT_TRUE(simulation.apply(SetGapWidth{"hand", 0.0}).success);
  EXPECT_TRUE(
      simulation.apply(GuideObstacle{"ball", {ball, Vec3::Zero(), Vec3::Zero(), 0.5}}).success);
  EXPECT_FALSE(simulation.apply(SetClampTarget{"foot", hand.target()}).success);
  EXPECT_FALSE(simulation.apply(SetStiffness{-1.0}).success);
  EXPECT_TRUE(simulation.isAsleep());
}

// ---- determinism -------------------------------------------------------------------------------

/// The towel with a coarse criterion of rest, so that a run is short with every method.
Scene hasty(const std::string& method) {
  Scene scene = towel(method);
  scene.solver.sleep = SleepSettings{0.01, 0.1};
  return scene;
}

/// The hash of a run that falls asleep, is woken by the wind, and falls asleep again.
std::uint64_t hashOfARun(const std::string& method) {
  Simulation simulation(hasty(method));
  const int first = runToSleep(simulation);
  run(simulation, 20);
  EXPECT_TRUE(simulation.apply(SetWind{Wind{Vec3(0.0, 0.5, 0.0), 1.2, 1.0}}).success);
  run(simulation, 5);
  EXPECT_FALSE(simulation.isAsleep());
  EXPECT_TRUE(simulation.apply(SetWind{}).success);
  const int second = runToSleep(simulation);
  Hash hash;
  const std::uint64_t end = hashOf(simulation);
  hash.add(&first, sizeof first);
  hash.add(&second, sizeof second);
  hash.add(&end, sizeof end);
  return hash.value();
}

class SleepMethods : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Registry, SleepMethods,
                         testing::ValuesIn(testing_support::boundedSolverNames()),
                         [](const auto& test) { return test.param; });

TEST_P(SleepMethods, AnyNumberOfThreadsGivesTheSameBits) {
  std::set<std::uint64_t> hashes;
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    hashes.insert(hashOfARun(GetParam()));
  }
  EXPECT_EQ(hashes.size(), 1U);
}

TEST_P(SleepMethods, GoesOnFromASavedState) {
  Simulation straight(hasty(GetParam()));
  // Saves and loads every 17 steps until the cloth is asleep.
  while (!straight.isAsleep() && straight.stepCount() < kMost) {
    straight.step();
    if (straight.stepCount() % 17 != 0) continue;
    Simulation relay(hasty(GetParam()));
    relay.load(straight.save());
    straight = std::move(relay);
  }
  Simulation whole(hasty(GetParam()));
  runToSleep(whole);
  ASSERT_EQ(whole.stepCount(), straight.stepCount());
  run(straight, 10);
  run(whole, 10);
  Simulation loaded(hasty(GetParam()));
  loaded.load(straight.save());
  EXPECT_TRUE(loaded.isAsleep());
  for (Simulation* simulation : {&straight, &whole, &loaded}) {
    run(*simulation, 10);
    EXPECT_TRUE(simulation->isAsleep());
    ASSERT_TRUE(simulation->apply(SetGravity{Vec3(0.0, 1.0, -9.0)}).success);
    run(*simulation, 3);
  }
  EXPECT_EQ(whole.save(), straight.save());
  EXPECT_EQ(loaded.save(), straight.save());
  EXPECT_NEAR(loaded.timeAsleep(), 0.2, 1e-9);
}

}  // namespace
}  // namespace cloth_sim
