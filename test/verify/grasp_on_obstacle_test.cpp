/// \file Clamps that grasp cloth lying on an obstacle, and are driven into it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "fewer_cases.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

/// A cloth draped over a sphere on a table, with a clamp for the middle (on the sphere) and one for
/// a corner (on the table).
Scene drapedScene(const std::string& method) {
  // The methods with a limit get a soft fabric and enough substeps for it: h = 1/60/100 s is below
  // 2 / omega_max, about 2 sqrt(m / (8 k)) = 2 sqrt(0.19 / 33^2 / (8 * 60)) = 1.2 ms. The others
  // take what they take by default.
  const SolverInfo& info = findSolver(method);
  const bool limited = std::isfinite(info.stabilityLimit);
  const double usual = completeParameters(info, {}).at("substeps");
  const std::string substeps = std::to_string(limited ? 100 : static_cast<int>(usual));
  return parseScene(R"(
cloth:
  size: [0.8, 0.8]
  particles: [33, 33]
  pose: {position: [0.0, 0.0, 0.25]}
  fabric: {areal_density: 0.3, tensile_warp: 60, tensile_weft: 60, shear: 10, bending: 0}
solver: {method: )" + method +
                        R"(, substeps: )" + substeps + R"(}
drag: 1.0
obstacles:
  table: {type: board, size: [1.6, 1.6, 0.05], position: [0, 0, -0.025]}
  sphere: {type: sphere, radius: 0.1, position: [0, 0, 0.1]}
clamps:
  top: {patch: {particle: [16, 16], radius: 2}}
  corner: {patch: {particle: [2, 2], radius: 2}}
phases:
  - {name: settle, until: {mean_speed: {below: 0.1, for: 0.2}}, timeout: 4, on_timeout: continue}
  - {name: attach, clamps: {all: {attach: true}}, until: {clamps: at_target}, timeout: 5}
  - {name: close, clamps: {all: {grasp: true}}, until: {clamps: closed}, timeout: 3}
  - {name: push, clamps: {all: {move_by: [0.0, 0.0, -0.15]}}, until: {clamps: at_target}, timeout: 5}
  - {name: lift, clamps: {all: {move_by: [0.0, 0.0, 0.5]}}, until: {clamps: at_target}, timeout: 5}
)",
                    "draped");
}

double deepest(const Simulation& simulation) {
  double least = 0.0;
  for (const Collider& collider : simulation.colliders().all()) {
    for (const Vec3& x : simulation.state().x) {
      least = std::min(least, collider.gap(x, simulation.time()));
    }
  }
  return least;
}

double fastest(const Simulation& simulation) {
  double speed = 0.0;
  for (const Vec3& v : simulation.state().v) speed = std::max(speed, v.norm());
  return speed;
}

class GraspOnObstacle : public ::testing::TestWithParam<std::string> {};

// Obstacles push the held particles out wherever the clamp wants them, so nothing is pushed
// through: the deepest overlap is that of the gap between sphere and table, which is thinner than
// the cloth (1 mm). And nothing explodes: the fastest that anything should go is the clamps' own
// 0.5 m/s, the fall over an edge of the drape (2 g 0.2 m: 2 m/s), and what the stretched cloth
// gives back.
TEST_P(GraspOnObstacle, NeitherPushesClothThroughNorMakesItExplode) {
  Simulation simulation(drapedScene(GetParam()));
  bool held = false;
  while (simulation.script().status() != ScriptStatus::kDone) {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
    EXPECT_GT(deepest(simulation), -1e-3) << "t = " << simulation.time();
    const std::string phase = simulation.script().history().back().name;
    if (phase == "settle") continue;
    EXPECT_LT(fastest(simulation), 6.0) << phase << ", t = " << simulation.time();
    held = held || simulation.clamps()[0].held().size() == 25;
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_TRUE(held);
}

INSTANTIATE_TEST_SUITE_P(Registry, GraspOnObstacle,
                         ::testing::ValuesIn(fewerCasesOf(boundedSolverNames())),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace cloth_sim
