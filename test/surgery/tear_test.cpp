/// \file Tears through moving cloth: their direction and speed.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "surgery/geometry.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace surgery_support;

/// A scene with cloth of an isotropic fabric and a transverse notch in its middle. Two clamps that
/// hold it along lines at 120 degrees pull it at 30 degrees to its threads.
std::string obliqueScene(double dt, int substeps, const std::string& tearing) {
  std::ostringstream yaml;
  yaml.precision(17);
  yaml << R"(
seed: 1
cloth:
  size: [0.6, 0.6]
  particles: [41, 41]
  fabric: {areal_density: 0.2, tensile_warp: 400, tensile_weft: 400, shear: 150, bending: 0, damping: 2.0e-5}
  bending: none
solver: {method: symplectic_euler, dt: )"
       << dt << ", substeps: " << substeps << R"(}
gravity: [0, 0, 0]
drag: 20.0
clamps:
  left:
    pose: {position: [-0.1732, -0.1, 0.0], rpy: [0, 0, 0.5235987755982988]}
    plate_size: [0.04, 0.9]
    gap_open: 0.02
    gap_closed: 0.002
  right:
    pose: {position: [0.1732, 0.1, 0.0], rpy: [0, 0, 0.5235987755982988]}
    plate_size: [0.04, 0.9]
    gap_open: 0.02
    gap_closed: 0.002
tearing: {enabled: false, ratio: 1.35, tip_speed: 2.0)"
       << tearing << R"(}
phases:
  - {name: grasp, clamps: {all: {grasp: true}}, until: {clamps: closed}, timeout: 1}
  - name: pull
    tearing: {enabled: true, ratio: 1.25}
    notch: [[0.33000, 0.24804], [0.27000, 0.35196]]
    clamps:
      left: {move_by: [-0.0866, -0.05, 0], speed: 0.2}
      right: {move_by: [0.0866, 0.05, 0], speed: 0.2}
    until: {pieces: 2}
    timeout: 1.5
)";
  return yaml.str();
}

/// Runs the phases to their end.
void finish(Simulation& simulation) {
  while (simulation.script().status() != ScriptStatus::kDone && !simulation.failed()) {
    simulation.step();
  }
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
}

/// Returns the end of the last phase [s].
double endOf(const Simulation& simulation) {
  return simulation.script().history().back().end.value();
}

/// Returns the direction of the main crack: of those torn edges within `radius` of the middle, at
/// rest, that are connected to the notch [degrees, 0 to 180].
double directionOfMainCrack(const TriangleMesh& mesh, const Vec2& middle, double radius) {
  const std::vector<TornEdge> edges = tornEdges(mesh);
  // Torn edges that share a place hang together; side branches do too, but they weigh little.
  std::vector<Vec2> reached{middle};
  std::vector<bool> used(edges.size(), false);
  const auto at = [](const Vec2& p, const Vec2& q) { return (p - q).norm() < 1e-9; };
  std::size_t first = 0;
  for (std::size_t k = 1; k < edges.size(); ++k) {
    if ((edges[k].from - middle).norm() < (edges[first].from - middle).norm()) first = k;
  }
  reached = {edges[first].from};
  for (std::size_t r = 0; r < reached.size(); ++r) {
    for (std::size_t k = 0; k < edges.size(); ++k) {
      if (used[k]) continue;
      if (!at(edges[k].from, reached[r]) && !at(edges[k].to, reached[r])) continue;
      used[k] = true;
      reached.push_back(at(edges[k].from, reached[r]) ? edges[k].to : edges[k].from);
    }
  }
  // The line through the middles of these edges, weighted by length.
  double weight = 0.0;
  Vec2 centre = Vec2::Zero();
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const bool second : {false, true}) {
    for (std::size_t k = 0; k < edges.size(); ++k) {
      const Vec2 p = 0.5 * (edges[k].from + edges[k].to);
      if (!used[k] || (p - middle).norm() > radius) continue;
      const double length = (edges[k].to - edges[k].from).norm();
      if (second) {
        spread += length * (p - centre) * (p - centre).transpose();
      } else {
        weight += length;
        centre += length * p;
      }
    }
    if (!second) centre /= weight;
  }
  const Vec2 d = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvectors().col(1);
  const double angle = std::atan2(d.y(), d.x()) * 180.0 / M_PI;
  return angle < 0.0 ? angle + 180.0 : angle;
}

class ObliqueTear : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Refined, ObliqueTear,
                         testing::Values("", ", refine_tip: {radius: 0.02, generations: 2}"),
                         [](const auto& test) {
                           return std::string(test.param).empty() ? "Not" : "AtTheTip";
                         });

TEST_P(ObliqueTear, RunsAcrossThePull) {
  // At right angles to the largest tension: 120 degrees, whatever way the mesh runs (edges at 0, 45
  // and 90 degrees). 15 degrees are less than what it takes to tell it from a mesh direction.
  Simulation simulation(parseScene(obliqueScene(0.004, 50, GetParam()), "oblique.yaml"));
  finish(simulation);
  EXPECT_GE(simulation.pieces(), 2);
  EXPECT_EQ(validationError(simulation.model().mesh), "");
  const Vec2 middle(0.3, 0.3);
  const double angle = directionOfMainCrack(simulation.model().mesh, middle, 0.25);
  EXPECT_NEAR(angle, 120.0, 15.0);
  RecordProperty("degrees", std::to_string(angle));
}

TEST(TearTime, OfAFreeTearDoesNotDependOnTheStep) {
  // Substeps keep their length, so that only the interval at which it is looked for tears differs.
  std::vector<double> ends;
  for (const int part : {1, 2}) {
    Simulation simulation(parseScene(obliqueScene(0.004 / part, 50 / part, ""), "oblique.yaml"));
    finish(simulation);
    ends.push_back(endOf(simulation));
  }
  EXPECT_NEAR(ends[1], ends[0], 0.02 * ends[0]);
}

constexpr char kStraightSeam[] = "[[0.23, 0], [0.23, 0.46]]";

/// A small version of the shipped tearing scene: the cloth is pulled apart at the bent seam.
std::string seamScene(double dt, int substeps, double tipSpeed, const std::string& seam) {
  std::ostringstream yaml;
  yaml.precision(17);
  yaml << R"(
seed: 7
cloth:
  size: [0.46, 0.46]
  particles: [24, 24]
  fabric: {preset: cotton, damping: 2.0e-5}
  bending: springs
solver: {method: xpbd, dt: )"
       << dt << ", substeps: " << substeps << R"(}
gravity: [0, 0, 0]
drag: 1.0
clamps:
  left: {patch: {particle: [2, 12], radius: 3}, gap_open: 0.02, gap_closed: 0.01}
  right: {patch: {particle: [21, 12], radius: 3}, gap_open: 0.02, gap_closed: 0.01}
tearing: {enabled: true, ratio: 3.0, tip_speed: )"
       << tipSpeed << R"(, seam: {path: )" << seam << R"(}}
phases:
  - {name: close, clamps: {all: {grasp: true}}, until: {clamps: closed}, timeout: 3.0}
  - name: pull_and_tear
    notch: [[0.23, 0.0], [0.23, 0.045]]
    tearing: {ratio: 1.2}
    clamps:
      left: {move_by: [-0.3, 0.0, 0.0], speed: 0.4}
      right: {move_by: [0.3, 0.0, 0.0], speed: 0.4}
    until: {pieces: 2}
    timeout: 10.0
)";
  return yaml.str();
}

/// Returns the time between the first and the last torn spring [s].
double timeToTearThrough(Simulation& simulation) {
  finish(simulation);
  EXPECT_EQ(simulation.pieces(), 2);
  std::vector<double> times;
  for (const FailureEvent& event : simulation.takeEvents()) {
    if (event.cause == FailureCause::kTear) times.push_back(event.time);
  }
  return times.back() - times.front();
}

class SeamTime : public testing::TestWithParam<double> {};

TEST_P(SeamTime, DoesNotDependOnTheStep) {
  // Substeps keep their length. When the clamps begin to pull is seen up to a step late; when each
  // spring tears is not.
  std::vector<double> times;
  for (const int part : {1, 2, 4, 8}) {
    const std::string scene = seamScene(1.0 / 60.0 / part, 40 / part, GetParam(), kStraightSeam);
    Simulation simulation(parseScene(scene, "seam.yaml"));
    times.push_back(timeToTearThrough(simulation));
  }
  for (std::size_t k = 1; k < times.size(); ++k) {
    EXPECT_NEAR(times[k], times[k - 1], 0.02 * times[k - 1]) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(TipSpeeds, SeamTime, testing::Values(0.5, 5.0));

TEST(TearLine, OfABentSeamLiesOnIt) {
  const MaterialPath seam{{0.23, 0.0}, {0.23, 0.1}, {0.251, 0.23}, {0.213, 0.35}, {0.227, 0.46}};
  const std::string path = "[[0.23, 0], [0.23, 0.1], [0.251, 0.23], [0.213, 0.35], [0.227, 0.46]]";
  Simulation simulation(parseScene(seamScene(1.0 / 60.0, 20, 0.5, path), "bent.yaml"));
  finish(simulation);
  EXPECT_EQ(simulation.pieces(), 2);
  EXPECT_EQ(validationError(simulation.model().mesh), "");
  EXPECT_LT(farthestFrom(seam, simulation.model().mesh), 1e-9);
  EXPECT_GT(tornEdges(simulation.model().mesh).size(), 40U);
}

}  // namespace
}  // namespace cloth_sim
