/// \file Layers of cloth: no frame has an intersection, and layers rest, stick and slide as they
/// should.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "cloth_sim/threads/thread_limit.h"
#include "fewer_cases.h"
#include "unit/scene_support.h"
#include "verify/intersections.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using verify_support::fastestSpeed;

/// A towel that falls on its edge and crumples.
constexpr const char* kCrumple = R"(
cloth:
  size: [0.4, 0.4]
  particles: [25, 25]
  pose: {position: [0.0, 0.0, 0.22], orientation: [0.66, 0.05, 0.02, 0.749]}
  fabric: cotton
  thickness: 0.001
drag: 0.5
obstacles:
  table: {type: board, size: [1.6, 1.6, 0.05], position: [0.0, 0.0, -0.025]}
)";

std::string withLayers(const std::string& yaml, const std::string& solver) {
  return yaml + "self_contact: true\nsolver: " + solver + "\n";
}

Simulation crumpled(const std::string& solver) {
  return Simulation(parseScene(withLayers(kCrumple, solver), "crumple"));
}

TEST(Layers, WithoutThemTheClothPassesThroughItself) {
  Simulation simulation(
      parseScene(std::string(kCrumple) + "solver: {method: xpbd, substeps: 20}\n", "crumple"));
  int intersections = 0;
  for (int step = 0; step < 45; ++step) {
    simulation.step();
    intersections += countIntersections(simulation.model(), simulation.state());
  }
  EXPECT_GT(intersections, 100);
  EXPECT_FALSE(simulation.layerReport().has_value());
}

class LayersWith : public testing::TestWithParam<const char*> {};

TEST_P(LayersWith, NoFrameHasAnIntersection) {
  Simulation simulation = crumpled(GetParam());
  std::int64_t truncated = 0;
  std::int64_t moves = 0;
  const int steps = std::max(9, fewerCases(45));
  for (int step = 0; step < steps; ++step) {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
    ASSERT_EQ(countIntersections(simulation.model(), simulation.state()), 0) << step;
    const LayerReport report = simulation.layerReport().value();
    EXPECT_EQ(report.unproven, 0);
    truncated += report.truncated;
    moves += report.moves;
  }
  EXPECT_LT(static_cast<double>(truncated), 0.01 * static_cast<double>(moves)) << "it is rare";
}

INSTANTIATE_TEST_SUITE_P(Methods, LayersWith,
                         testing::Values("{method: line_xpbd, error: 0.01}",
                                         "{method: xpbd, substeps: 20}",
                                         "{method: pbd, substeps: 8}",
                                         "{method: verlet, substeps: 400}",
                                         "{method: symplectic_euler, substeps: 400}"));

TEST(Layers, AMethodThatDivergesIsToldSo) {
  Simulation simulation = crumpled("{method: verlet, substeps: 20}");
  for (int step = 0; step < 20 && !simulation.failed(); ++step) simulation.step();
  EXPECT_NE(simulation.failure().find("verlet diverged"), std::string::npos);
}

TEST(Layers, AMethodThatCannotHoldThemIsRefused) {
  for (const std::string method : {"projective", "tr_bdf2", "explicit_euler"}) {
    try {
      crumpled("{method: " + method + "}");
      FAIL() << method;
    } catch (const SceneError& error) {
      EXPECT_NE(std::string(error.what()).find("self_contact: " + method + " cannot hold layers"),
                std::string::npos)
          << error.what();
    }
  }
}

/// Flat square cloths above each other, each smaller than the one below by `less` [m] and turned
/// against it.
std::string stackOf(int layers, double less, const std::string& rest) {
  std::string yaml = "cloth:\n";
  for (int k = 0; k < layers; ++k) {
    const double half = 0.05 * k;
    const std::string size = std::to_string(0.24 - less * k);
    yaml += "  - {name: c" + std::to_string(k) + ", size: [" + size + ", " + size +
            "], particles: [17, 17], " +
            "fabric: cotton, thickness: 0.001, pose: {position: [0, 0, " +
            std::to_string(0.0005 + 0.0013 * k) + "], orientation: [0, 0, " +
            std::to_string(std::sin(half)) + ", " + std::to_string(std::cos(half)) + "]}}\n";
  }
  return yaml +
         "drag: 2\nself_contact: true\nsolver: {method: line_xpbd, error: 0.01, "
         "sleep: false}\n" +
         rest;
}

double meanHeight(const Simulation& simulation, std::size_t cloth) {
  const ClothPart& part = simulation.model().cloths[cloth];
  double sum = 0.0;
  for (VertexId v = 0; v < part.vertices; ++v)
    sum += simulation.state().x[part.firstVertex + v].z();
  return sum / part.vertices;
}

/// A stack after some time on a table.
Simulation restingStack(int layers, double less, int steps) {
  Simulation simulation(
      parseScene(stackOf(layers, less,
                         "obstacles: {table: {type: board, size: [1, 1, 0.1], position: [0, 0, "
                         "-0.05]}}\n"),
                 "stack"));
  for (int step = 0; step < steps; ++step) simulation.step();
  return simulation;
}

void expectAThicknessApart(const Simulation& simulation) {
  for (std::size_t k = 0; k + 1 < simulation.model().cloths.size(); ++k) {
    const double gap = meanHeight(simulation, k + 1) - meanHeight(simulation, k);
    EXPECT_NEAR(gap, 0.001, 0.00001) << k;
  }
}

TEST(Layers, AStackRestsAThicknessApart) {
  const Simulation simulation = restingStack(4, 0.04, 90);
  expectAThicknessApart(simulation);
  EXPECT_LT(fastestSpeed(simulation.state()), 0.001);
  EXPECT_LT(static_cast<double>(simulation.layerReport()->truncated),
            1e-3 * static_cast<double>(simulation.layerReport()->moves));
}

TEST(Layers, AStackOfTenRestsAThicknessApart) {
  const Simulation simulation = restingStack(10, 0.015, 60);
  expectAThicknessApart(simulation);
  EXPECT_LT(fastestSpeed(simulation.state()), 0.001);
  EXPECT_EQ(countIntersections(simulation.model(), simulation.state()), 0);
}

TEST(Layers, TenClothsWeighWhatTenWeigh) {
  std::string yaml =
      "cloth:\n  - {name: held, size: [0.3, 0.3], particles: [13, 13], fabric: cotton, thickness: "
      "0.001, pins: [corner_00, corner_01, corner_10, corner_11]}\n";
  for (int k = 1; k <= 9; ++k) {
    const std::string size = std::to_string(0.2 - 0.01 * k);
    yaml += "  - {name: c" + std::to_string(k) + ", size: [" + size + ", " + size +
            "], particles: [9, 9], fabric: cotton, thickness: 0.001, pose: {position: [0, 0, " +
            std::to_string(0.0013 * k) + "]}}\n";
  }
  Simulation simulation(parseScene(
      yaml + "drag: 5\nself_contact: true\nsolver: {error: 0.01, sleep: false}\n", "weigh"));
  double load = 0.0;
  constexpr int kSettling = 150;
  constexpr int kWeighing = 30;
  for (int step = 0; step < kSettling + kWeighing; ++step) {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
    if (step < kSettling) continue;
    for (const Vec3& f : simulation.lastReport().reactions) load -= f.z() / kWeighing;
  }
  const double weight = totalMass(simulation.model()) * verify_support::kGravity;
  EXPECT_NEAR(load / weight, 1.0, 0.005);
}

/// Distance that the upper one of two cloths slides between two steps on a slope of 20 degrees [m].
double slideOf(double friction, int firstStep, int lastStep) {
  const double angle = 20.0 * M_PI / 180.0;
  const std::string yaml =
      stackOf(2, 0.04,
              "layer_friction: " + std::to_string(friction) + "\ngravity: [" +
                  std::to_string(9.81 * std::sin(angle)) + ", 0, " +
                  std::to_string(-9.81 * std::cos(angle)) + "]\n" +
                  "obstacles: {table: {type: board, size: [1, 1, 0.1], position: [0, 0, -0.05], "
                  "friction: 5}}\n");
  Simulation simulation(parseScene(yaml, "slope"));
  const auto middle = [&](std::size_t cloth) {
    const ClothPart& part = simulation.model().cloths[cloth];
    return simulation.state().x[part.firstVertex + part.vertices / 2].x();
  };
  int step = 0;
  for (; step < firstStep; ++step) simulation.step();
  const double before = middle(1) - middle(0);
  for (; step < lastStep; ++step) simulation.step();
  return middle(1) - middle(0) - before;
}

TEST(Layers, FrictionHoldsBelowItsAngleOnly) {
  // tan(20 degrees) is 0.364.
  EXPECT_LT(std::abs(slideOf(0.5, 3, 18)), 2e-4);
  EXPECT_LT(std::abs(slideOf(0.38, 3, 18)), 5e-4);
  EXPECT_GT(slideOf(0.34, 3, 18), 2e-3);
  // 9.81 (sin - 0.2 cos) t^2 / 2 from 0.05 s on is 0.06 m; drag takes some.
  EXPECT_GT(slideOf(0.2, 3, 18), 0.03);
}

/// docs/layers.md tells how much.
TEST(Layers, WhatFrictionHoldsCreepsLittleInASecond) {
  EXPECT_LT(std::abs(slideOf(0.5, 60, 120)), 8e-5);
  EXPECT_LT(std::abs(slideOf(0.38, 60, 120)), 3.2e-4) << "tan(20 degrees) is 0.364";
}

TEST(Layers, AClampThatWouldDriveClothThroughHeldClothIsBlocked) {
  const std::string yaml = R"(
cloth:
  - {name: lower, size: [0.1, 0.1], particles: [9, 9], fabric: cotton, thickness: 0.001}
  - {name: upper, size: [0.1, 0.1], particles: [9, 9], fabric: cotton, thickness: 0.001,
     pose: {position: [0, 0, 0.03]}}
self_contact: true
gravity: [0, 0, 0]
drag: 2
solver: {method: line_xpbd, error: 0.01}
clamps:
  floor: {patch: {cloth: lower, particle: [4, 4], radius: 8}, closing_speed: 1}
  hand: {patch: {cloth: upper, particle: [4, 4], radius: 1}, closing_speed: 1, max_speed: 1}
phases:
  - name: grasp
    clamps: {all: {attach: true, grasp: true, speed: 1}}
    until: {clamps: [at_target, closed]}
    timeout: 2
  - name: down
    clamps: {hand: {move_by: [0, 0, -0.05], speed: 0.2}}
    until: {clamps: at_target}
    timeout: 0.5
    on_timeout: continue
)";
  Simulation simulation(parseScene(yaml, "blocked"));
  bool isHandBlocked = false;
  for (int step = 0; step < 200 && simulation.script().status() != ScriptStatus::kDone; ++step) {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
    ASSERT_EQ(countIntersections(simulation.model(), simulation.state()), 0) << simulation.time();
    const auto snapshot = simulation.snapshot(Detail::kShape);
    EXPECT_FALSE(snapshot->clamps[0].blocked) << "it stands still";
    if (snapshot->clamps[1].blocked) isHandBlocked = true;
  }
  EXPECT_EQ(simulation.script().status(), ScriptStatus::kDone);
  EXPECT_TRUE(isHandBlocked);
  // The clamp waits for its cloth, which keeps its shape but for the motion of a step.
  const Clamp& hand = simulation.clamps()[1];
  EXPECT_GT(hand.pose().position.z(), 0.0);
  EXPECT_FALSE(hand.atTarget());
  const double height = simulation.state().x[hand.held().front()].z();
  for (const VertexId v : hand.held()) {
    EXPECT_NEAR(simulation.state().x[v].z(), height, 0.2 / 60.0 + 1e-3);
  }
}

/// Clamps close over folds whose sides lie beyond a plate. These kept a clamp back for good
/// where all came to lie in the plane of that plate.
TEST(Layers, AClampThatHasClosedOverASharpFoldLiftsIt) {
  Simulation simulation(
      loadScene(std::string(CLOTH_SIM_SOURCE_DIR) + "/test/ros/tear_48.yaml",
                {"seed=2", "self_contact=true", "solver={error: 0.01, dt: 0.016666666666666666}"}));
  const auto isLifting = [&] {
    const PhaseSpec* phase = simulation.script().current();
    return phase != nullptr && phase->name != "lower_and_notch";
  };
  int blocked = 0;
  do {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
    if (simulation.layerReport()->blocked > 0) ++blocked;
  } while (isLifting() && simulation.time() < 6.0);
  EXPECT_LT(simulation.time(), 5.5) << "1.5 s after the clamps have closed";
  EXPECT_LT(blocked, 10);
  EXPECT_EQ(countIntersections(simulation.model(), simulation.state()), 0);
}

TEST(Layers, ClothThatIntersectsItselfAtTheStartIsRefused) {
  const std::string yaml = R"(
cloth:
  - {name: a, size: [0.2, 0.2], particles: [9, 9], fabric: cotton}
  - {name: b, size: [0.2, 0.2], particles: [9, 9], fabric: cotton,
     pose: {orientation: [0.7071067811865476, 0, 0, 0.7071067811865476]}}
self_contact: true
)";
  try {
    Simulation simulation(parseScene(yaml, "cross"));
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("touches or intersects itself at the start"),
              std::string::npos);
  }
}

TEST(Layers, ClothThatIsTooThickForItsMeshIsThinnedWithAWord) {
  const std::string yaml =
      "cloth: {size: [0.2, 0.2], particles: [9, 9], fabric: cotton, thickness: 0.05}\n"
      "self_contact: true\n";
  const Simulation simulation(parseScene(yaml, "thick"));
  ASSERT_EQ(simulation.warnings().size(), 1U);
  EXPECT_NE(simulation.warnings()[0].text.find("its layers keep 0.0125 m apart"), std::string::npos)
      << simulation.warnings()[0].text;
}

std::uint64_t hashAfter(int steps, int threads) {
  const ThreadLimit limit(threads);
  Simulation simulation = crumpled("{method: line_xpbd, error: 0.01}");
  for (int step = 0; step < steps; ++step) simulation.step();
  return stateHash(simulation.model(), simulation.state());
}

TEST(Layers, TheBitsDoNotDependOnTheNumberOfThreads) {
  EXPECT_EQ(hashAfter(25, 1), hashAfter(25, 2));
}

TEST(Layers, ASavedStateGoesOnToTheBit) {
  Simulation one = crumpled("{method: line_xpbd, error: 0.01}");
  Simulation other = crumpled("{method: line_xpbd, error: 0.01}");
  for (int step = 0; step < 25; ++step) {
    one.step();
    if (step % 4 == 0) other.load(one.save());
    if (step % 4 != 0) other.step();
    ASSERT_EQ(stateHash(one.model(), one.state()), stateHash(other.model(), other.state())) << step;
  }
}

/// A knot bears the tension of its strip where layers press on each other, and `line_xpbd` adds
/// inertia there. Contacts that do not see it drive the strip, to strains of 0.75 at rest. With 120
/// substeps and no added inertia the largest strain of the run is 0.034.
TEST(Layers, AKnotThatIsPulledTightComesToRest) {
  Simulation simulation(loadScene(testing_support::shipped("knot")));
  double largest = 0.0;
  constexpr int kMostSteps = 300;
  for (int step = 0; step < kMostSteps; ++step) {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
    largest = std::max(largest, maxStretch(simulation.model(), simulation.state()) - 1.0);
    if (simulation.script().status() == ScriptStatus::kDone) break;
  }
  EXPECT_EQ(simulation.script().status(), ScriptStatus::kDone);
  EXPECT_LT(largest, 0.1);
  EXPECT_LT(fastestSpeed(simulation.state()), 0.1);
  verify_support::record("largest_strain", largest);
}

/// Edges that lie over lower ones go up and down from substep to substep, here at 27 mm/s; from
/// step to step nothing moves.
TEST(Layers, CrossedClothsFallAsleep) {
  std::vector<std::string> small;
  for (int k = 0; k < 4; ++k) {
    const std::string cloth = "cloth." + std::to_string(k);
    small.push_back(cloth + ".size=[0.1, 0.1]");
    small.push_back(cloth + ".particles=[17, 17]");
  }
  Simulation simulation(loadScene(testing_support::shipped("stack"), small));
  double fastest = 0.0;
  while (simulation.time() < 3.0 && !simulation.isAsleep()) {
    fastest = fastestSpeed(simulation.state());
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
  }
  EXPECT_TRUE(simulation.isAsleep());
  EXPECT_GT(fastest, 0.001) << "velocities at the end of a substep alone would do";
  EXPECT_EQ(countIntersections(simulation.model(), simulation.state()), 0);
  verify_support::record("at_rest_after", simulation.time());
}

/// A strip of the towel of fold_towel.yaml with its particles at 128 x 96: trials of longer
/// substeps made the fold jolt again and again.
TEST(Layers, AFoldComesToRest) {
  const std::vector<std::string> strip{"cloth.size=[0.48, 0.0227]", "cloth.particles=[128, 7]",
                                       "clamps.near.pose.position=[0.228, 0, 0.002]",
                                       "clamps.far=null"};
  Simulation simulation(loadScene(testing_support::shipped("fold_towel"), strip));
  constexpr double kMost = 9.0;  // of which the fold takes 3 [s]
  while (simulation.time() < kMost && !simulation.isAsleep()) {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
  }
  EXPECT_TRUE(simulation.isAsleep()) << fastestSpeed(simulation.state());
  EXPECT_EQ(countIntersections(simulation.model(), simulation.state()), 0);
  verify_support::record("at_rest_after", simulation.time());
}

TEST(Layers, APileWhoseBendingIsDampedFallsAsleep) {
  Simulation simulation(loadScene(testing_support::shipped("pile")));
  while (simulation.time() < 3.0 && !simulation.isAsleep()) simulation.step();
  EXPECT_TRUE(simulation.isAsleep());
  EXPECT_EQ(countIntersections(simulation.model(), simulation.state()), 0);
  verify_support::record("asleep_after_s", simulation.time());
}

class ShippedLayers : public testing::TestWithParam<const char*> {};

/// Long scenes end in less time with the check in one of six frames.
TEST_P(ShippedLayers, EndWithoutAnIntersection) {
  const std::string name = GetParam();
  Simulation simulation(loadScene(testing_support::shipped(name)));
  constexpr int kEvery = 6;
  constexpr int kMostSteps = 1200;
  std::int64_t truncated = 0;
  std::int64_t moves = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
    const LayerReport report = simulation.layerReport().value();
    ASSERT_EQ(report.unproven, 0) << simulation.time();
    truncated += report.truncated;
    moves += report.moves;
    const bool isDone = simulation.script().status() == ScriptStatus::kDone;
    if (isDone || step % kEvery == 0) {
      ASSERT_EQ(countIntersections(simulation.model(), simulation.state()), 0) << simulation.time();
    }
    if (isDone) break;
  }
  EXPECT_EQ(simulation.script().status(), ScriptStatus::kDone);
  const double share = static_cast<double>(truncated) / static_cast<double>(moves);
  EXPECT_LT(share, 0.001);
  verify_support::record("truncated", share);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, ShippedLayers,
    testing::ValuesIn(fewerCasesOf<const char*>({"twist", "stack", "pile", "napkin_ring", "knot",
                                                 "fold_quarters", "fold_towel"})));

}  // namespace
}  // namespace cloth_sim
