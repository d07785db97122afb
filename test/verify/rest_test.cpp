/// \file Cloths at rest on obstacles, or coming to rest: Coulomb friction and the loads on
/// obstacles.

#include <gtest/gtest.h>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace verify_support;

class Resting : public OverMethods {
 protected:
  /// Returns a scene with the method of the test. Its substeps resolve the cloth, omega_max h =
  /// 0.5, and its retardation time is 1 / omega_max, with which forward Euler is stable too.
  Scene sceneOf(ClothSpec cloth, double dt) const {
    cloth.fabric.damping = 0.0;
    const double omega = frequencyBound(buildModel(cloth));
    cloth.fabric.damping = 1.0 / omega;
    Scene scene;
    scene.cloths[0] = cloth;
    scene.solver.method = GetParam();
    scene.solver.dt = dt;
    const double substeps = std::ceil(dt * omega / 0.5);
    scene.solver.parameters = completeParameters(info(), {{"substeps", substeps}});
    return scene;
  }
};

INSTANTIATE_TEST_SUITE_P(Registry, Resting, testing::ValuesIn(solverNames()),
                         [](const auto& test) { return test.param; });

constexpr double kFriction = 0.4;
constexpr double kDt = 1.0 / 60.0;  // [s]

Fabric sheet() {
  Fabric fabric;
  fabric.arealDensity = 0.2;
  fabric.tensileWarp = 2.0;
  fabric.tensileWeft = 2.0;
  fabric.shear = 0.5;
  fabric.bending = 1e-6;
  fabric.thickness = 1e-3;
  return fabric;
}

/// A cloth on a table whose top contains the origin and is rotated by `angle` about y.
void layOnTable(Scene& scene, double angle) {
  const Quat turn(Eigen::AngleAxisd(angle, Vec3::UnitY()));
  Obstacle table;
  table.name = "table";
  table.shape = BoxShape{Vec3(2.0, 2.0, 0.1)};
  table.pose = {turn * Vec3(0.0, 0.0, -0.05), turn};
  table.friction = kFriction;
  scene.obstacles = {table};
  scene.cloths[0].pose = {turn * Vec3(0.0, 0.0, 0.5 * scene.cloths[0].fabric.thickness), turn};
}

void run(Simulation& simulation, double seconds) {
  const double end = simulation.time() + seconds - 1e-9;
  while (simulation.time() < end) {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
  }
}

// ---- friction -----------------------------------------------------------------------------------

TEST_P(Resting, AMinuteOnATiltedTableIsNoDrift) {
  // At 0.01 rad below the angle of friction. In the first second the cloth may settle to where its
  // rounding allows; after that a particle that sticks is put back to the very bits of where it
  // was.
  Scene scene = sceneOf(clothOf(4, 4, 0.05, sheet()), kDt);
  layOnTable(scene, std::atan(kFriction) - 0.01);
  Simulation simulation(scene);
  const State start = simulation.state();
  run(simulation, 1.0);
  const State settled = simulation.state();
  run(simulation, 59.0);
  double drift = 0.0, settling = 0.0;
  for (VertexId v = 0; v < simulation.model().particleCount(); ++v) {
    drift = std::max(drift, (simulation.state().x[v] - settled.x[v]).norm());
    settling = std::max(settling, (settled.x[v] - start.x[v]).norm());
  }
  record("drift", drift);
  record("settling", settling);
  EXPECT_EQ(drift, 0.0);
  EXPECT_LT(settling, 1e-9);
}

TEST_P(Resting, SlidesOnALevelTableByCoulombsDistance) {
  // v^2 / (2 mu g); the whole sheet slides as one. Where in a substep it stops is not resolved, and
  // its velocity is known to mu g h: the way to v h.
  const double speed = 0.8;
  Scene scene = sceneOf(clothOf(4, 4, 0.05, sheet()), kDt);
  layOnTable(scene, 0.0);
  scene.cloths[0].velocity = Vec3(speed, 0.0, 0.0);
  scene.solver.parameters["substeps"] *= 8.0;
  Simulation simulation(scene);
  const Vec3 start = centreOfMass(simulation.model(), simulation.state());
  run(simulation, 1.0);
  const double way = (centreOfMass(simulation.model(), simulation.state()) - start).norm();
  const double expected = speed * speed / (2.0 * kFriction * kGravity);
  record("way_over_closed_form", way / expected);
  EXPECT_NEAR(way, expected, speed * kDt / simulation.lastReport().substeps);
  // At rest, a method whose contacts only correct positions shows what gravity adds in a substep.
  record("speed_at_rest", meanSpeed(simulation.state()));
  EXPECT_LE(meanSpeed(simulation.state()),
            1.001 * kGravity * kDt / simulation.lastReport().substeps);
}

// ---- weight -------------------------------------------------------------------------------------

/// Returns the mean force on all obstacles over `seconds` [N].
Vec3 meanForce(Simulation& simulation, double seconds) {
  Vec3 impulse = Vec3::Zero();
  const double from = simulation.time();
  while (simulation.time() < from + seconds - 1e-9) {
    simulation.step();
    for (const ContactCandidates& c : simulation.contacts().candidates) impulse += c.impulse.linear;
  }
  return impulse / (simulation.time() - from);
}

TEST_P(Resting, ATableBearsTheWeightOfTheClothOnIt) {
  // The cloth does not move, so only rounding is left: a particle's impulse is m dx / h, with dx to
  // 1e-16 m over h^2 g = 1e-5 m.
  Scene scene = sceneOf(clothOf(5, 5, 0.05, sheet()), kDt);
  layOnTable(scene, 0.0);
  Simulation simulation(scene);
  run(simulation, 0.5);
  const Vec3 force = meanForce(simulation, 0.2);
  const double weight = totalMass(simulation.model()) * kGravity;
  record("force_over_weight", -force.z() / weight);
  EXPECT_NEAR(-force.z() / weight, 1.0, 1e-9);
  EXPECT_LT(force.head<2>().norm(), 1e-9 * weight);
}

TEST_P(Resting, ATableBearsTheTorqueOfAClothBesideItsMiddle) {
  Scene scene = sceneOf(clothOf(5, 5, 0.05, sheet()), kDt);
  layOnTable(scene, 0.0);
  scene.obstacles[0].pose.position += Vec3(0.11, -0.07, 0.0);
  Simulation simulation(scene);
  run(simulation, 0.5);
  const auto snapshot = simulation.snapshot();
  const Wrench& wrench = snapshot->obstacleWrenches[0];
  const Vec3 weight(0.0, 0.0, -kGravity * totalMass(simulation.model()));
  const Vec3 arm = centreOfMass(simulation.model(), simulation.state()) -
                   simulation.scene().obstacles[0].pose.position;
  const Vec3 torque = arm.cross(weight);
  record("torque_error", (wrench.torque - torque).norm() / torque.norm());
  EXPECT_LT((wrench.force - weight).norm(), 1e-6 * weight.norm());
  EXPECT_LT((wrench.torque - torque).norm(), 1e-6 * torque.norm());
}

TEST_P(Resting, ASphereBearsTheWeightOfTheClothDrapedOverIt) {
  // Swinging (at 10 rad/s or so, against a drag of 10/s) has died away as exp(-15) after 3 s; of
  // what creeps on, the drag bears M v drag: 1e-3 of the weight at 1 mm/s. Methods that let the
  // drag act on a velocity that gravity has changed already lose up to drag h of the weight at
  // rest.
  Scene scene = sceneOf(clothOf(9, 9, 0.04, sheet()), kDt);
  const double radius = 0.1;
  Obstacle ball;
  ball.name = "ball";
  ball.shape = SphereShape{radius};
  ball.friction = 0.8;
  scene.obstacles = {ball};
  scene.cloths[0].pose.position.z() = radius + 0.5 * scene.cloths[0].fabric.thickness;
  scene.drag = 10.0;
  Simulation simulation(scene);
  run(simulation, 3.0);
  const Vec3 force = meanForce(simulation, 0.5);
  const double weight = totalMass(simulation.model()) * kGravity;
  record("force_over_weight", -force.z() / weight);
  record("mean_speed", meanSpeed(simulation.state()));
  const double h = kDt / simulation.lastReport().substeps;
  EXPECT_NEAR(-force.z() / weight, 1.0, 1e-3 + scene.drag * h);
  EXPECT_LT(force.head<2>().norm(), 2e-3 * weight);
}

// ---- velocities ---------------------------------------------------------------------------------

/// Whether bending is by springs or by the energy of a plate.
class Draped : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Bending, Draped, testing::Values("springs", "plate"),
                         [](const auto& test) { return test.param; });

TEST_P(Draped, HasTheVelocitiesOfACloth) {
  // Of a cloth that lies still, velocities vanish at the end of each substep. They do not if forces
  // that hold each other act in different ones: with bending in every second substep particles went
  // to and fro at 0.25 and 0.05 m/s.
  Simulation simulation(parseScene(R"(
cloth: {size: [0.5, 0.5], particles: [64, 64], pose: {position: [0, 0, 0.3]}, fabric: cotton,
        bending: )" + GetParam() + R"(}
solver: {method: line_xpbd, substeps: 40, dt: 0.016666666666666666, sleep: false}
drag: 6
obstacles:
  table: {type: plane}
  ball: {type: sphere, radius: 0.1, position: [0, 0, 0.1], friction: 0.5}
)",
                                   "draped.yaml"));
  run(simulation, 2.0);
  const double fastest = fastestSpeed(simulation.state());
  record("fastest", fastest);
  EXPECT_LT(fastest, 0.02);  // [m/s]
}

}  // namespace
}  // namespace cloth_sim
