/// \file Cloth on surfaces of triangles, against what the shapes that they stand for do.

#include <gtest/gtest.h>

#include <algorithm>

#include "cloth_sim/sim/simulation.h"
#include "cloth_sim/threads/thread_limit.h"
#include "unit/surfaces.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace verify_support;

constexpr double kDt = 1.0 / 60.0;  // [s]

Scene clothOver(const Obstacle& obstacle, int particles, double side, double height,
                const std::string& method = "line_xpbd") {
  Scene scene;
  const double spacing = side / (particles - 1);
  scene.cloths[0] = clothOf(particles, particles, spacing, fabricPreset("cotton"));
  scene.cloths[0].pose.position.z() = height;
  scene.obstacles = {obstacle};
  scene.solver.method = method;
  scene.solver.dt = kDt;
  scene.solver.parameters = completeParameters(findSolver(method), {});
  scene.solver.sleep.reset();
  return scene;
}

void runFor(Simulation& simulation, double seconds) {
  for (int k = 0; k < std::lround(seconds / kDt); ++k) simulation.step();
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
}

Obstacle named(const Shape& shape, double friction) {
  Obstacle obstacle;
  obstacle.name = "it";
  obstacle.shape = shape;
  obstacle.friction = friction;
  return obstacle;
}

TEST(ContactMesh, ABallOfTrianglesDrapesAsASphere) {
  // The triangles, of which an edge has 0.05 radii, are up to 0.06 mm below the sphere that they
  // stand for. The rest is what a drape makes of it: its folds swing.
  constexpr double kRadius = 0.15;
  const SurfaceParts ball = ballOf(kRadius, 5);
  ASSERT_EQ(ball.triangles.size(), 8192U);
  std::vector<std::vector<Vec3>> drapes;
  for (const Shape& shape : {Shape(SphereShape{kRadius}), Shape(ball.shape())}) {
    Scene scene = clothOver(named(shape, 0.8), 33, 0.4, kRadius + 0.001);
    scene.drag = 4.0;
    Simulation simulation(scene);
    runFor(simulation, 2.0);
    drapes.push_back(simulation.state().x.values());
  }
  double sum = 0.0;
  double onBall = 0.0;
  for (std::size_t k = 0; k < drapes[0].size(); ++k) {
    const double off = (drapes[0][k] - drapes[1][k]).norm();
    sum += off;
    if (drapes[0][k].z() > 0.95 * kRadius) onBall = std::max(onBall, off);
  }
  record("mean_mm", 1e3 * sum / static_cast<double>(drapes[0].size()));
  record("most_on_top_mm", 1e3 * onBall);
  EXPECT_LT(sum / static_cast<double>(drapes[0].size()), 0.002);
  EXPECT_LT(onBall, 0.001);
}

class ContactMeshMethods : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Methods, ContactMeshMethods,
                         testing::Values("line_xpbd", "xpbd", "pbd", "projective", "implicit_euler",
                                         "tr_bdf2"));

TEST_P(ContactMeshMethods, ASheetAt20MetresPerSecondLiftsAClothOnItsSide) {
  Obstacle board = named(sheetOf(0.8, 0.8, 20, 20).shape(), 0.3);
  board.velocity = Vec3(0.0, 0.0, 20.0);
  Simulation simulation(clothOver(board, 21, 0.4, 0.3, GetParam()));
  for (int k = 0; k < 12; ++k) {
    simulation.step();
    const Pose pose = simulation.colliders().all()[0].poseAt(simulation.time());
    for (const Vec3& x : simulation.state().x) {
      ASSERT_GT(pose.toLocal(x).z(), 0.0) << k;
    }
  }
  EXPECT_GT(simulation.state().x[0].z(), 3.0) << "it took the cloth along";
}

TEST_P(ContactMeshMethods, ATurningSheetThrowsAClothWithoutPassingIt) {
  // The rim of the sheet, 0.4 m from its axis, has 20 m/s. Particles that have been over the sheet
  // since the start must be on the side where they began.
  Obstacle board = named(sheetOf(0.8, 0.8, 20, 20).shape(), 0.3);
  board.angularVelocity = Vec3(0.0, -50.0, 0.0);
  Scene scene = clothOver(board, 21, 0.2, 0.001, GetParam());
  scene.cloths[0].pose.position.x() = 0.2;
  Simulation simulation(scene);
  std::vector<bool> isOver(simulation.state().x.size(), true);
  for (int k = 0; k < 6; ++k) {
    simulation.step();
    const Pose pose = simulation.colliders().all()[0].poseAt(simulation.time());
    for (std::size_t v = 0; v < isOver.size(); ++v) {
      const Vec3 local = pose.toLocal(simulation.state().x.values()[v]);
      isOver[v] = isOver[v] && local.head<2>().cwiseAbs().maxCoeff() < 0.38;
      if (isOver[v]) {
        ASSERT_GT(local.z(), 0.0) << k;
      }
    }
    if (k == 0) {
      EXPECT_GT(std::count(isOver.begin(), isOver.end(), true), 200);
    }
  }
}

TEST(ContactMesh, ClothOnAnInclineSticksBelowTheAngleOfFrictionAndSlidesAbove) {
  const double mu = 0.4;
  for (const double tilt : {0.9, 1.1}) {
    const double angle = tilt * std::atan(mu);
    Obstacle incline = named(sheetOf(2.0, 1.0, 83, 57).shape(), mu);
    incline.pose.orientation = Quat(Eigen::AngleAxisd(angle, Vec3::UnitY()));
    Scene scene = clothOver(incline, 21, 0.3, 0.0);
    scene.cloths[0].pose.orientation = incline.pose.orientation;
    scene.cloths[0].pose.position =
        incline.pose.toWorld(Vec3(-0.3, 0.1, 0.5 * scene.cloths[0].fabric.thickness));
    Simulation simulation(scene);
    runFor(simulation, 0.2);
    const std::vector<Vec3> before = simulation.state().x.values();
    const Vec3 velocity = simulation.state().v[220];
    runFor(simulation, 0.6);
    const Vec3 moved = simulation.state().x[220] - before[220];
    record("moved_m", moved.norm());
    if (tilt < 1.0) {
      EXPECT_LT(moved.norm(), 1e-6);
    } else {
      // Coulomb's law; symplectic Euler is late by half a substep.
      const double a = kGravity * (std::sin(angle) - mu * std::cos(angle));
      EXPECT_NEAR(moved.norm(), velocity.norm() * 0.6 + 0.5 * a * 0.36, 0.02 * a * 0.36);
    }
  }
}

TEST(ContactMesh, IsTheSameOnOneAndTwoThreads) {
  std::vector<std::uint64_t> hashes;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    Obstacle ball = named(ballOf(0.15, 5).shape(), 0.3);
    ball.angularVelocity = Vec3(0.0, 0.0, 3.0);
    Simulation simulation(clothOver(ball, 96, 0.4, 0.1512));
    runFor(simulation, 0.5);
    hashes.push_back(stateHash(simulation.model(), simulation.state()));
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

}  // namespace
}  // namespace cloth_sim
