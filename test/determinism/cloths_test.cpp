/// \file Several cloths in one scene, by every method: each moves as it does alone, with the same
/// bits at any number of threads and from a saved state.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/threads/thread_limit.h"
#include "determinism/busy_scene.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using testing_support::hashOf;

/// A sheet that hangs by one corner, and a heavier strip that swings down onto a ball.
const char* const kSheet = R"(
  - {name: sheet, size: [0.4, 0.3], particles: [25, 19], fabric: silk, pins: [corner_00],
     pose: {position: [0, 0, 0.9], rpy: [0.3, 0, 0]}}
)";
const char* const kStrip = R"(
  - {name: strip, size: [0.2, 0.5], particles: [11, 26], fabric: denim, pins: [last_row],
     pose: {position: [2, 0, 0.9]}}
)";
const char* const kRest = R"(
obstacles: {ball: {type: sphere, radius: 0.1, position: [2.0, -0.1, 0.75]}}
drag: 1
)";

/// Methods with a stability limit get substeps of 0.1 ms, which is below a limit of 2 / omega_max,
/// or shorter ones if their limit is less.
Scene sceneOf(const std::string& cloths, const std::string& method, const std::string& more = "") {
  const double limit = findSolver(method).stabilityLimit;
  const double count = std::isfinite(limit) ? std::ceil(50.0 * std::max(1.0, 2.0 / limit)) : 5.0;
  const std::string substeps = std::to_string(static_cast<int>(count));
  return parseScene("cloth:" + cloths + kRest + more, "cloths.yaml",
                    {"solver={method: " + method + ", dt: 0.005, substeps: " + substeps + "}"});
}

void run(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.step();
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
}

class Cloths : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Registry, Cloths, testing::ValuesIn(testing_support::boundedSolverNames()),
                         [](const auto& test) { return test.param; });

TEST_P(Cloths, MoveAsTheyDoAlone) {
  Simulation both(sceneOf(std::string(kSheet) + kStrip, GetParam()));
  Simulation sheet(sceneOf(kSheet, GetParam()));
  Simulation strip(sceneOf(kStrip, GetParam()));
  for (Simulation* simulation : {&both, &sheet, &strip}) run(*simulation, 30);
  // Methods that iterate end by the residual of all cloths, and so earlier or later than for one;
  // tr_bdf2 also takes a substep of backward Euler with all cloths where one touches (0.0015 m
  // here). The others differ by rounding only.
  const bool iterates = both.lastReport().iterations > 0;
  double far = 0.0;
  double moved = 0.0;
  const VertexId first = both.model().cloths[1].firstVertex;
  for (VertexId v = 0; v < both.model().particleCount(); ++v) {
    const Vec3& x = v < first ? sheet.state().x[v] : strip.state().x[v - first];
    far = std::max(far, (both.state().x[v] - x).norm());
    moved = std::max(moved, both.state().v[v].norm());
  }
  EXPECT_LT(far, iterates ? 2e-3 : 1e-9);
  EXPECT_GT(moved, 0.5) << "they were to move";
}

TEST_P(Cloths, AnyNumberOfThreadsGivesTheSameBits) {
  const std::string notch =
      "phases: [{name: cut, notch: {cloth: strip, path: [[0.09, 0.0], [0.09, 0.2]]}}]";
  std::set<std::uint64_t> hashes;
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    Simulation simulation(sceneOf(std::string(kSheet) + kStrip, GetParam(), notch));
    run(simulation, 12);
    EXPECT_GT(simulation.broken().cut, 0);
    hashes.insert(hashOf(simulation));
  }
  EXPECT_EQ(hashes.size(), 1U);
}

TEST_P(Cloths, GoOnFromASavedState) {
  const std::string more = R"(
clamps: {hand: {patch: {cloth: strip, particle: [5, 2], radius: 1}, closing_speed: 20}}
phases:
  - {name: fall, timeout: 0.05}
  - {name: grasp, clamps: {hand: {attach: true, grasp: true, speed: 20}}, timeout: 0.05}
  - {name: cut, notch: {cloth: strip, path: [[-0.01, 0.3], [0.21, 0.3]]}}
)";
  const Scene scene = sceneOf(std::string(kSheet) + kStrip, GetParam(), more);
  Simulation straight(scene);
  run(straight, 26);
  EXPECT_EQ(straight.pieces(), 3);
  EXPECT_EQ(straight.clamps()[0].held().size(), 9U) << "the strip was to be grasped";
  Simulation loaded(scene);
  loaded.load(straight.save());
  run(straight, 6);
  run(loaded, 6);
  EXPECT_EQ(hashOf(straight), hashOf(loaded));
  EXPECT_EQ(straight.save(), loaded.save());
}

}  // namespace
}  // namespace cloth_sim
