/// \file Sharp corners and edges of meshes against faces and edges of a coarse cloth: neither a
/// spike nor a blade shows through between particles.

#include <gtest/gtest.h>

#include <algorithm>

#include "cloth_sim/sim/simulation.h"
#include "unit/surfaces.h"
#include "verify/intersections.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace verify_support;

constexpr double kDt = 1.0 / 60.0;  // [s]

/// A closed pyramid with its tip at the origin, far thinner than a cell of the cloths here.
SurfaceParts spikeOf(double height, double width) {
  SurfaceParts spike;
  const double w = 0.5 * width;
  spike.vertices = {
      {0, 0, 0}, {-w, -w, -height}, {w, -w, -height}, {w, w, -height}, {-w, w, -height}};
  spike.triangles = {{{0, 1, 2}}, {{0, 2, 3}}, {{0, 3, 4}}, {{0, 4, 1}}, {{1, 3, 2}}, {{1, 4, 3}}};
  return spike;
}

/// An open sheet that stands upright along y, its upper edge at z = 0.
SurfaceParts bladeOf(double length, double height) {
  SurfaceParts blade;
  const double l = 0.5 * length;
  blade.vertices = {{0, -l, 0}, {0, l, 0}, {0, l, -height}, {0, -l, -height}};
  blade.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  return blade;
}

Shape sharpMesh(const SurfaceParts& parts) {
  MeshShape shape = parts.shape();
  shape.sharpEdges = true;
  return shape;
}

/// A cloth of 9 x 9 particles, 50 mm apart, above the origin, which is in the middle of a face.
Scene coarseCloth(const Shape& shape, double height, const std::string& method) {
  Scene scene;
  scene.cloths[0] = clothOf(9, 9, 0.05, fabricPreset("cotton"));
  scene.cloths[0].pose.position = Vec3(0.02, 0.015, height);
  Obstacle obstacle;
  obstacle.name = "it";
  obstacle.shape = shape;
  obstacle.friction = 0.5;
  scene.obstacles = {obstacle};
  scene.solver.method = method;
  scene.solver.dt = kDt;
  scene.solver.parameters = completeParameters(findSolver(method), {});
  scene.solver.sleep.reset();
  return scene;
}

/// Counts the edges of the mesh that pass through faces of the cloth, and of the cloth through
/// triangles of the mesh.
int intersections(const Simulation& simulation, const SurfaceParts& parts) {
  const Pose pose = simulation.colliders().all()[0].poseAt(simulation.time());
  int count = 0;
  for (const Face& face : simulation.model().mesh.faces()) {
    std::array<Vec3, 3> cloth;
    for (int k = 0; k < 3; ++k) cloth[k] = pose.toLocal(simulation.state().x[face[k]]);
    for (const TriangleSurface::Triangle& t : parts.triangles) {
      std::array<Vec3, 3> mesh;
      for (int k = 0; k < 3; ++k) mesh[k] = parts.vertices[t[k]];
      for (int k = 0; k < 3; ++k) {
        count += passesThrough(mesh[k], mesh[(k + 1) % 3], cloth) ? 1 : 0;
        count += passesThrough(cloth[k], cloth[(k + 1) % 3], mesh) ? 1 : 0;
      }
    }
  }
  return count;
}

class ContactFeatures : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Methods, ContactFeatures,
                         testing::Values("line_xpbd", "xpbd", "pbd", "implicit_euler", "verlet"));

/// Drives an obstacle up through the cloth, and checks after each step that neither passes the
/// other. \param parts  its surface.
Simulation driveUp(const Shape& shape, const SurfaceParts& parts, double speed,
                   const std::string& method) {
  Scene scene = coarseCloth(shape, 0.05, method);
  scene.obstacles[0].velocity = Vec3(0.0, 0.0, speed);
  Simulation simulation(scene);
  const int steps = static_cast<int>(std::lround((0.15 / speed + 0.05) / kDt)) + 1;
  for (int k = 0; k < steps; ++k) {
    simulation.step();
    EXPECT_EQ(intersections(simulation, parts), 0) << speed << " m/s, step " << k;
  }
  return simulation;
}

TEST_P(ContactFeatures, ASpikeBetweenParticlesLiftsTheCloth) {
  const SurfaceParts spike = spikeOf(0.3, 0.006);
  for (const double speed : {0.5, 5.0, 20.0}) {
    const Simulation simulation = driveUp(sharpMesh(spike), spike, speed, GetParam());
    const Pose pose = simulation.colliders().all()[0].poseAt(simulation.time());
    double highest = -1.0;
    for (const Vec3& x : simulation.state().x) highest = std::max(highest, pose.toLocal(x).z());
    EXPECT_GT(highest, -0.01) << "cloth is where the tip is";
  }
}

TEST_P(ContactFeatures, ABladeBetweenParticlesLiftsTheCloth) {
  const SurfaceParts blade = bladeOf(1.0, 0.4);
  for (const double speed : {0.5, 20.0}) driveUp(sharpMesh(blade), blade, speed, GetParam());
}

/// A box smaller than the cloth, whose edges and corners are between its particles.
TEST_P(ContactFeatures, ABoxBetweenParticlesLiftsTheCloth) {
  BoxShape box{Vec3(0.13, 0.09, 0.06)};
  box.sharpEdges = true;
  const TriangleSurface surface = boxSurface(box.size);
  const SurfaceParts parts{surface.vertices(), surface.triangles()};
  for (const double speed : {0.5, 5.0}) driveUp(box, parts, speed, GetParam());
}

TEST(ContactFeature, AClothOnThePointsOfABedOfNailsPressesWithItsWeight) {
  SurfaceParts nails;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -2; j <= 2; ++j) {
      const SurfaceParts spike = spikeOf(0.2, 0.004);
      const auto first = static_cast<std::int32_t>(nails.vertices.size());
      for (const Vec3& x : spike.vertices)
        nails.vertices.push_back(x + Vec3(0.09 * i, 0.09 * j, 0));
      for (const auto& [a, b, c] : spike.triangles) {
        nails.triangles.push_back({{first + a, first + b, first + c}});
      }
    }
  }
  Scene scene = coarseCloth(sharpMesh(nails), 0.01, "line_xpbd");
  scene.drag = 5.0;
  Simulation simulation(scene);
  double force = 0.0;
  for (int k = 0; k < 180; ++k) {
    simulation.step();
    if (k % 20 == 0) {
      ASSERT_EQ(intersections(simulation, nails), 0) << "step " << k;
    }
    if (k >= 120) force += simulation.snapshot()->obstacleWrenches[0].force.z() / 60.0;
  }
  double mass = 0.0;
  for (const double m : simulation.model().mass) mass += m;
  EXPECT_NEAR(force, -9.81 * mass, 0.02 * 9.81 * mass);
}

TEST(ContactFeature, AClothThatBeginsOnTheTipOfASpikeIsPushedOff) {
  const SurfaceParts spike = spikeOf(0.3, 0.006);
  Scene scene = coarseCloth(sharpMesh(spike), -0.005, "line_xpbd");
  Simulation simulation(scene);
  EXPECT_GT(intersections(simulation, spike), 0);
  for (int k = 0; k < 30; ++k) simulation.step();
  EXPECT_EQ(intersections(simulation, spike), 0);
}

}  // namespace
}  // namespace cloth_sim
