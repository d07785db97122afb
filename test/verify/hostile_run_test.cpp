/// \file Runs that drive a cloth beyond reason, with `step_guard: subdivide`: they are saved, or
/// end with one line that says why not.

#include <gtest/gtest.h>

#include <functional>

#include "cloth_sim/sim/simulation.h"
#include "fewer_cases.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace verify_support;

/// A cotton of 0.2 m that hangs from its upper row, guarded.
Scene guardedScene(const std::string& method) {
  Scene scene;
  scene.cloths[0] = clothOf(9, 9, 0.2 / 8, fabricPreset("cotton"));
  scene.cloths[0].fabric.damping = 1e-3;  // forward Euler is stable at no step without
  scene.cloths[0].pose.orientation = Quat(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX()));
  for (int column = 0; column < 9; ++column) scene.cloths[0].pins.push_back({column, 8});
  scene.solver.method = method;
  scene.solver.dt = 1.0 / 60.0;
  scene.solver.guard = StepGuard::kSubdivide;
  scene.solver.parameters = completeParameters(findSolver(method), {});
  return scene;
}

void takeSteps(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.step();
}

/// A clamp leaves for a place 100 m away, at once.
void yank(Simulation& simulation) {
  simulation.apply(SetGrasp{"hand", true});
  takeSteps(simulation, 12);
  Pose away = simulation.scene().clamps[0].pose;
  away.position.x() += 100.0;
  simulation.apply(SetClampTarget{"hand", away});
  takeSteps(simulation, 30);
}

/// Two balls of 10 cm close on the cloth until they overlap.
void squeeze(Simulation& simulation) {
  takeSteps(simulation, 6);
  for (int k = 0; k < 30; ++k) {
    const double y = 0.3 - 0.01 * k;
    simulation.apply(MoveObstacle{"left", Pose{Vec3(0.0, -y, 0.0), Quat::Identity()}});
    simulation.apply(MoveObstacle{"right", Pose{Vec3(0.0, y, 0.0), Quat::Identity()}});
    simulation.step();
  }
}

void addHand(Scene& scene) {
  scene.clamps = {quickHand(scene, {4, 1, 2}, -0.075)};
  scene.clamps[0].maxLinearSpeed = 1e4;
  scene.clamps[0].maxLinearAcceleration = 1e8;
}

void addBalls(Scene& scene) {
  for (const auto& [name, y] : {std::pair("left", -0.3), std::pair("right", 0.3)}) {
    Obstacle ball;
    ball.name = name;
    ball.shape = SphereShape{0.1};
    ball.pose.position.y() = y;
    scene.obstacles.push_back(ball);
  }
}

class HostileRun : public OverMethods {
 protected:
  /// Runs a scene, and expects it to end well or with a line that says why not.
  void expectSaved(const Scene& scene, const std::function<void(Simulation&)>& run) {
    Simulation simulation(scene);
    run(simulation);
    EXPECT_TRUE(isFinite(simulation.state()));
    if (!simulation.failed()) return;
    // Only forward Euler, which gains energy at any step without damping, is beyond saving.
    EXPECT_EQ(GetParam(), "explicit_euler") << simulation.failure();
    EXPECT_NE(simulation.failure().find("the most that step_guard tries"), std::string::npos)
        << simulation.failure();
    EXPECT_EQ(simulation.failure().find('\n'), std::string::npos);
  }
};

INSTANTIATE_TEST_SUITE_P(Registry, HostileRun, testing::ValuesIn(fewerCasesOf(solverNames())),
                         [](const auto& test) { return test.param; });

TEST_P(HostileRun, ClampYankedAwayBy100Metres) {
  Scene scene = guardedScene(GetParam());
  addHand(scene);
  expectSaved(scene, yank);
}

TEST_P(HostileRun, SqueezedBetweenObstacles) {
  Scene scene = guardedScene(GetParam());
  addBalls(scene);
  expectSaved(scene, squeeze);
}

TEST_P(HostileRun, WindOf300MetresPerSecond) {
  Scene scene = guardedScene(GetParam());
  scene.wind = Wind{Vec3(0.0, 300.0, 2.0)};
  expectSaved(scene, [](Simulation& simulation) { takeSteps(simulation, 12); });
}

}  // namespace
}  // namespace cloth_sim
