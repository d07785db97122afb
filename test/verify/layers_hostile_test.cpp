/// \file Layers of cloth under attack: obstacles that are shot or pressed into them, clamps that
/// are driven through them, collisions in free space, and runs that are saved after every step.

#include <gtest/gtest.h>

#include <cmath>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "cloth_sim/threads/thread_limit.h"
#include "verify/intersections.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using verify_support::record;

constexpr const char* kLineXpbd =
    "self_contact: true\nsolver: {method: line_xpbd, error: 0.01, sleep: false}\n";
constexpr const char* kXpbd =
    "self_contact: true\nsolver: {method: xpbd, substeps: 20, sleep: false}\n";

/// Takes a step, and expects a state that is finite and has no intersection.
void stepSafely(Simulation& simulation) {
  simulation.step();
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  ASSERT_TRUE(isFinite(simulation.state())) << simulation.time();
  ASSERT_EQ(countIntersections(simulation.model(), simulation.state()), 0) << simulation.time();
  ASSERT_EQ(simulation.layerReport()->unproven, 0) << simulation.time();
}

/// Cloths of 11 x 11 above each other, the lowest at `z` [m], each turned against the one below.
std::string stackAt(double z, int layers, const std::string& more = "") {
  std::string yaml = "cloth:\n";
  for (int k = 0; k < layers; ++k) {
    const double half = 0.05 * k;
    yaml += "  - {name: c" + std::to_string(k) +
            ", size: [0.24, 0.24], particles: [11, 11], fabric: cotton, thickness: 0.001, pose: "
            "{position: [0, 0, " +
            std::to_string(z + 0.0013 * k) + "], orientation: [0, 0, " +
            std::to_string(std::sin(half)) + ", " + std::to_string(std::cos(half)) + "]}" + more +
            "}\n";
  }
  return yaml;
}

// ---- momentum

Vec3 momentumOf(const Simulation& simulation) {
  Vec3 sum = Vec3::Zero();
  const Model& model = simulation.model();
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    sum += model.mass[v] * simulation.state().v[v];
  }
  return sum;
}

/// Two cloths that fly into each other where nothing else acts. XPBD conserves momentum; line_xpbd
/// does not where it adds inertia.
std::string collision(double speed) {
  const std::string s = std::to_string(speed);
  return R"(
cloth:
  - {name: a, size: [0.2, 0.2], particles: [13, 13], fabric: cotton, thickness: 0.001,
     velocity: [0, 0, )" +
         s + R"(]}
  - {name: b, size: [0.14, 0.16], particles: [11, 13], fabric: denim, thickness: 0.001,
     velocity: [0, 0, -)" +
         s + R"(], pose: {position: [0.03, 0.01, 0.02], orientation: [0.03, 0.05, 0.2, 0.978]}}
gravity: [0, 0, 0]
)" + kXpbd;
}

/// The course of a collision.
struct Collision {
  double drift = 0.0;          ///< largest change of momentum over the sum of m |v| at the start
  std::int64_t truncated = 0;  ///< motions that the certificate changed
  int contacts = 0;            ///< most contacts in a substep
};

Collision collide(double speed, int steps) {
  Simulation simulation(parseScene(collision(speed), "collision"));
  const Vec3 before = momentumOf(simulation);
  double scale = 0.0;
  for (VertexId v = 0; v < simulation.model().particleCount(); ++v) {
    scale += simulation.model().mass[v] * simulation.state().v[v].norm();
  }
  Collision result;
  for (int step = 0; step < steps; ++step) {
    simulation.step();
    EXPECT_FALSE(simulation.failed()) << simulation.failure();
    result.drift = std::max(result.drift, (momentumOf(simulation) - before).norm() / scale);
    result.truncated += simulation.layerReport()->truncated;
    result.contacts = std::max(result.contacts, simulation.layerReport()->contacts);
  }
  return result;
}

/// Fast cloths are kept apart by the certificate as well.
TEST(HostileLayers, ACollisionInFreeSpaceChangesNoMomentum) {
  for (const double speed : {0.1, 0.3, 1.0, 3.0, 10.0}) {
    const Collision collision = collide(speed, speed > 1.0 ? 5 : 12);
    EXPECT_GT(collision.contacts, 5) << speed;
    EXPECT_LT(collision.drift, 1e-10) << speed;
    if (speed > 1.0) {
      EXPECT_GT(collision.truncated, 50) << speed;
    } else {
      EXPECT_EQ(collision.truncated, 0) << speed;
    }
    record("drift_" + std::to_string(speed).substr(0, 4), collision.drift);
  }
}

// ---- obstacles

/// Returns the largest depth of a particle in an obstacle [m].
double deepestIn(const Simulation& simulation, const std::string& obstacle) {
  double deepest = 0.0;
  for (const Vec3& x : simulation.state().x) {
    deepest = std::max(deepest, -simulation.colliders().find(obstacle)->gap(x, simulation.time()));
  }
  return deepest;
}

class Shot : public testing::TestWithParam<const char*> {
 protected:
  /// Shoots a ball upwards at 50 m/s, through cloths that are free or hang by their corners.
  void shoot(const std::string& pins) {
    Simulation simulation(parseScene(stackAt(0.3, 3, pins) +
                                         "drag: 0.5\nobstacles: {ball: {type: sphere, radius: "
                                         "0.04, position: [0.01, 0.02, 0.0], velocity: [0, 0, "
                                         "50]}}\n" +
                                         GetParam(),
                                     "shot"));
    double highest = 0.0;
    for (int step = 0; step < 10; ++step) {
      stepSafely(simulation);
      if (HasFatalFailure()) return;
      for (const Vec3& x : simulation.state().x) highest = std::max(highest, x.z());
    }
    EXPECT_GT(highest, 0.36) << "the ball takes cloth along";
  }
};

// Finer cloth, whose cells are smaller than what the ball moves in a substep, may make line_xpbd
// diverge (docs/layers.md, Limits).
INSTANTIATE_TEST_SUITE_P(HostileLayers, Shot, testing::Values(kLineXpbd, kXpbd));

TEST_P(Shot, ThroughAFreeStackMakesNoIntersection) { shoot(""); }

TEST_P(Shot, ThroughAHangingStackMakesNoIntersection) {
  shoot(", pins: [corner_00, corner_01, corner_10, corner_11]");
}

TEST(HostileLayers, ABallShotDownOntoAStackOnATableMakesNoIntersection) {
  // The obstacle goes into the table with the cloth between, which no cloth can follow.
  Simulation simulation(parseScene(
      stackAt(0.0005, 3) +
          "drag: 0.5\nobstacles:\n  table: {type: board, size: [1, 1, 0.1], position: [0, 0, "
          "-0.05]}\n  ball: {type: sphere, radius: 0.04, position: [0, 0, 1.3], velocity: [0, 0, "
          "-50]}\n" +
          kLineXpbd,
      "pressed"));
  for (int step = 0; step < 5; ++step) {
    stepSafely(simulation);
    if (HasFatalFailure()) return;
  }
}

/// A towel that begins to crumple on a table, far below a board.
Simulation crumpling() {
  return Simulation(parseScene(std::string(R"(
cloth:
  size: [0.3, 0.3]
  particles: [17, 17]
  pose: {position: [0.0, 0.0, 0.17], orientation: [0.66, 0.05, 0.02, 0.749]}
  fabric: cotton
  thickness: 0.001
drag: 0.5
obstacles:
  table: {type: board, size: [1.6, 1.6, 0.05], position: [0.0, 0.0, -0.025]}
  press: {type: board, size: [1.0, 1.0, 0.05], position: [0.0, 0.0, 0.425]}
)") + kLineXpbd,
                               "crumpling"));
}

Simulation heap() {
  Simulation simulation = crumpling();
  for (int step = 0; step < 24; ++step) simulation.step();
  return simulation;
}

/// Moves the board down at `speed` [m/s] until it is `gap` [m] above the table, and leaves it there
/// for some steps. \return how deep the cloth is in it, or in the table, at most [m].
double press(double speed, double gap) {
  Simulation simulation = heap();
  double top = 0.0;
  for (const Vec3& x : simulation.state().x) top = std::max(top, x.z());
  double under = top + 0.002;
  double deepest = 0.0;
  const auto place = [&](double velocity) {
    simulation.apply(MoveObstacle{
        "press", Pose{Vec3(0.0, 0.0, under + 0.025), Quat::Identity()}, {0.0, 0.0, -velocity}});
  };
  const double dt = simulation.scene().solver.dt;
  for (int rest = 0; rest < 5;) {
    const double now = std::min(speed, std::max(0.0, (under - gap) / dt));
    place(now);
    stepSafely(simulation);
    if (testing::Test::HasFatalFailure()) return 0.0;
    under -= now * dt;
    if (now == 0.0) ++rest;
    deepest = std::max({deepest, deepestIn(simulation, "press"), deepestIn(simulation, "table")});
  }
  return deepest;
}

TEST(HostileLayers, ABoardThatPressesAHeapMakesNoIntersection) {
  const double gently = press(0.5, 0.02);
  EXPECT_LT(gently, 2e-4);
  record("deepest_gently", gently);
}

TEST(HostileLayers, ABoardThatFlattensAHeapSinksIntoItWithoutAnIntersection) {
  // The heap has several layers of 1 mm: it cannot give way to 0.5 mm.
  const double flattened = press(5.0, 0.0005);
  EXPECT_GT(flattened, 1e-4);
  EXPECT_LT(flattened, 0.02);
  record("deepest_flattened", flattened);
}

// ---- clamps

TEST(HostileLayers, AClampDrivenIntoATableThroughFourLayersMakesNoIntersection) {
  Simulation simulation(parseScene(stackAt(0.0005, 4) + R"(
drag: 0.5
obstacles: {table: {type: board, size: [1, 1, 0.1], position: [0, 0, -0.05]}}
clamps:
  hand: {patch: {cloth: c3, particle: [5, 5], radius: 1}, closing_speed: 1, max_speed: 2}
phases:
  - {name: settle, timeout: 0.05, on_timeout: continue}
  - name: grasp
    clamps: {hand: {attach: true, grasp: true, speed: 2}}
    until: {clamps: [at_target, closed]}
    timeout: 2
  - name: drive
    clamps: {hand: {move_by: [0.02, 0, -0.08], speed: 2}}
    until: {clamps: at_target}
    timeout: 0.3
    on_timeout: continue
  - {name: stay, timeout: 0.05, on_timeout: continue}
)" + kLineXpbd,
                                   "driven"));
  int blocked = 0;
  double fastest = 0.0;
  for (int step = 0; step < 100 && simulation.script().status() != ScriptStatus::kDone; ++step) {
    stepSafely(simulation);
    if (HasFatalFailure()) return;
    if (simulation.snapshot(Detail::kShape)->clamps[0].blocked) ++blocked;
    for (const Vec3& v : simulation.state().v) fastest = std::max(fastest, v.norm());
  }
  EXPECT_EQ(simulation.script().status(), ScriptStatus::kDone);
  EXPECT_LT(fastest, 20.0) << "ten times as fast as the clamp";
  EXPECT_LT(deepestIn(simulation, "table"), 0.005) << "the cloth is pushed out of the table";
  record("blocked_steps", blocked);
  record("fastest", fastest);
}

// ---- saved states

std::vector<std::uint64_t> hashesOf(int steps, int threads, bool loadsEveryStep) {
  const ThreadLimit limit(threads);
  Simulation simulation = crumpling();
  std::vector<std::uint64_t> hashes;
  for (int step = 0; step < steps; ++step) {
    if (loadsEveryStep) {
      const std::string bytes = simulation.save();
      simulation = crumpling();
      simulation.load(bytes);
    }
    simulation.step();
    hashes.push_back(stateHash(simulation.model(), simulation.state()));
  }
  EXPECT_GT(simulation.layerReport()->contacts, 0);
  return hashes;
}

TEST(HostileLayers, ARunThatIsSavedAndLoadedAfterEveryStepHasTheSameBits) {
  const std::vector<std::uint64_t> straight = hashesOf(20, 1, false);
  EXPECT_EQ(hashesOf(20, 1, true), straight);
  EXPECT_EQ(hashesOf(20, 2, true), straight);
  EXPECT_EQ(hashesOf(20, 2, false), straight);
}

}  // namespace
}  // namespace cloth_sim
