/// \file Surfaces of triangles: closest points, sweeps and files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "cloth_sim/contact/collider.h"
#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "contact/closest_points.h"
#include "scene/obj_mesh.h"
#include "scene/surface_reader.h"
#include "unit/scene_support.h"
#include "unit/surfaces.h"

namespace cloth_sim {
namespace {

using testing::HasSubstr;
using namespace testing_support;

Vec3 pointIn(std::mt19937& random, double range) {
  std::uniform_real_distribution<double> coordinate(-range, range);
  const double x = coordinate(random);
  const double y = coordinate(random);
  return {x, y, coordinate(random)};
}

/// Triangles in any arrangement, most of them thin.
SurfaceParts randomTriangles(int count, unsigned seed) {
  std::mt19937 random(seed);
  SurfaceParts parts;
  for (int t = 0; t < count; ++t) {
    const Vec3 at = pointIn(random, 0.5);
    for (int k = 0; k < 3; ++k) parts.vertices.push_back(at + pointIn(random, 0.1));
    parts.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return parts;
}

double bruteDistance(const TriangleSurface& surface, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const TriangleSurface::Triangle& t : surface.triangles()) {
    const std::vector<Vec3>& x = surface.vertices();
    const auto w = closestOnTriangle(p, {x[t[0]], x[t[1]], x[t[2]]});
    least = std::min(least, (p - w[0] * x[t[0]] - w[1] * x[t[1]] - w[2] * x[t[2]]).norm());
  }
  return least;
}

TEST(TriangleSurface, ClosestPointIsThatOfASearchOfAllTriangles) {
  std::mt19937 random(5);
  for (const TriangleSurface& surface :
       {randomTriangles(1, 1).surface(), randomTriangles(300, 2).surface(),
        ballOf(0.4, 3).surface(), sheetOf(0.6, 0.4, 13, 7).surface()}) {
    for (int k = 0; k < 500; ++k) {
      const Vec3 p = pointIn(random, 0.8);
      const double brute = bruteDistance(surface, p);
      const double all = std::numeric_limits<double>::infinity();
      EXPECT_NEAR(surface.closest(p, all).distance, brute, 1e-12);
      EXPECT_NEAR(std::abs(surface.distance(p)), brute, 1e-12);
      for (const double limit : {0.5 * brute, 0.999 * brute, 1.001 * brute, 3.0 * brute}) {
        const bool isInside = surface.distance(p) < 0.0;
        EXPECT_EQ(surface.isWithin(p, limit, NearTriangles()), isInside || limit > brute);
      }
    }
  }
}

TEST(TriangleSurface, SignIsThatOfTheSolidAtFacesEdgesAndVertices) {
  SurfaceParts ball = ballOf(0.4, 2);
  for (int round = 0; round < 2; ++round) {
    const TriangleSurface surface = ball.surface();
    ASSERT_TRUE(surface.isClosed());
    std::mt19937 random(8);
    for (int k = 0; k < 500; ++k) {
      // Along the rays through vertices, middles of edges and points of faces.
      const auto& t = ball.triangles[static_cast<std::size_t>(k) % ball.triangles.size()];
      const Vec3 a = ball.vertices[t[0]], b = ball.vertices[t[1]], c = ball.vertices[t[2]];
      for (const Vec3& p : {a, Vec3(0.5 * (a + b)), Vec3((a + b + c) / 3.0)}) {
        EXPECT_GT(surface.distance(1.1 * p), 0.0);
        EXPECT_LT(surface.distance(0.9 * p), 0.0);
      }
    }
    for (auto& t : ball.triangles) std::swap(t[1], t[2]);  // inside out: the same solid
  }
}

TEST(TriangleSurface, SignIsRightAtTheHollowOfANotchedSolid) {
  // A wedge-shaped notch in a prism: at its bottom edge one normal alone gives the wrong sign.
  const std::vector<Vec2> outline{{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {0.0, -0.8}, {-1.0, 1.0}};
  SurfaceParts prism;
  for (const double z : {-1.0, 1.0}) {
    for (const Vec2& p : outline) prism.vertices.emplace_back(p.x(), p.y(), z);
  }
  for (int k = 0; k < 5; ++k) {
    const int next = (k + 1) % 5;
    prism.triangles.push_back({k, next, next + 5});
    prism.triangles.push_back({k, next + 5, k + 5});
  }
  for (const auto& [a, b, c] :
       std::vector<TriangleSurface::Triangle>{{0, 1, 3}, {1, 2, 3}, {0, 3, 4}}) {
    prism.triangles.push_back({a, c, b});
    prism.triangles.push_back({a + 5, b + 5, c + 5});
  }
  const TriangleSurface surface = prism.surface();
  ASSERT_TRUE(surface.isClosed());
  EXPECT_GT(surface.distance(Vec3(0.0, -0.7, 0.2)), 0.0);
  EXPECT_LT(surface.distance(Vec3(0.0, -0.85, 0.2)), 0.0);
  EXPECT_LT(surface.distance(Vec3(0.9, 0.5, -0.3)), 0.0);
  EXPECT_GT(surface.distance(Vec3(0.1, 0.5, -0.3)), 0.0);
}

TEST(TriangleSurface, ASheetHasNoInside) {
  const TriangleSurface sheet = sheetOf(1.0, 1.0, 3, 3).surface();
  EXPECT_FALSE(sheet.isClosed());
  EXPECT_EQ(sheet.doubt(), "");
  EXPECT_NEAR(sheet.distance(Vec3(0.1, 0.2, 0.3)), 0.3, 1e-15);
  EXPECT_NEAR(sheet.distance(Vec3(0.1, 0.2, -0.3)), 0.3, 1e-15);
}

TEST(TriangleSurface, NearlyClosedOnesAreDoubted) {
  SurfaceParts open = ballOf(0.4, 3);
  open.triangles.pop_back();
  EXPECT_FALSE(open.surface().isClosed());
  EXPECT_THAT(open.surface().doubt(), HasSubstr("3 edges"));
  SurfaceParts flipped = ballOf(0.4, 3);
  std::swap(flipped.triangles[7][0], flipped.triangles[7][1]);
  EXPECT_FALSE(flipped.surface().isClosed());
  EXPECT_THAT(flipped.surface().doubt(), HasSubstr("at 3 they turn"));
}

TEST(TriangleSurface, LeavesOutTrianglesWithoutArea) {
  SurfaceParts parts = sheetOf(1.0, 1.0, 2, 2);
  parts.triangles.push_back({0, 0, 1});
  parts.triangles.push_back({0, 1, 2});  // on a line
  EXPECT_EQ(parts.surface().triangles().size(), 8U);
}

// ---- sweeps -------------------------------------------------------------------------------------

Vec3 swept(const Collider& collider, const Vec3& start, const Vec3& end, double time, double h) {
  Contacts contacts;
  contacts.add(&collider).vertices.push_back(0);
  Vec3 x = end;
  const double mass = 0.01;
  ParticleView view;
  view.x = &x[0];
  view.y = &x[1];
  view.z = &x[2];
  view.startX = &start[0];
  view.startY = &start[1];
  view.startZ = &start[2];
  view.mass = &mass;
  contacts.project(view, time, h);
  return x;
}

/// Tells whether the segment between two points meets no triangle.
bool isClear(const TriangleSurface& surface, const Vec3& a, const Vec3& b) {
  for (double s = 0.0; s <= 1.0; s += 0.001) {
    if (surface.distance(a + s * (b - a)) < 2e-4) return false;
  }
  return true;
}

TEST(MeshSweep, NothingPassesTrianglesInAnyArrangement) {
  Obstacle obstacle;
  const SurfaceParts parts = randomTriangles(300, 4);
  const TriangleSurface surface = parts.surface();
  obstacle.shape = parts.shape();
  obstacle.friction = 0.4;
  std::mt19937 random(6);
  int shots = 0;
  for (int k = 0; k < 1000; ++k) {
    const Collider collider(obstacle, 0.001);
    const Vec3 start = pointIn(random, 0.6);
    if (surface.distance(start) < 0.001) continue;
    Vec3 x = start;
    Vec3 velocity = 20.0 * pointIn(random, 1.0).normalized();
    for (int step = 0; step < 3; ++step) {
      const Vec3 from = x;
      x = swept(collider, from, from + velocity / 60.0, (step + 1) / 60.0, 1.0 / 60.0);
      EXPECT_TRUE(isClear(surface, from, x)) << k << ' ' << step;
      velocity = (x - from) * 60.0 + 10.0 * pointIn(random, 1.0);
    }
    ++shots;
  }
  EXPECT_GT(shots, 900);
}

TEST(MeshSweep, ATurningSheetTakesParticlesAlongOnTheirSide) {
  // A sheet turns about its edge so that its rim has 20 m/s; particles lie a thickness above it.
  Obstacle board;
  board.shape = sheetOf(0.8, 0.4, 8, 4).shape();
  board.angularVelocity = Vec3(0.0, -50.0, 0.0);
  const Collider collider(board, 0.001);
  const double h = 1.0 / 240.0;
  std::mt19937 random(2);
  for (int k = 0; k < 200; ++k) {
    Vec3 x = pointIn(random, 0.15);
    const bool isAbove = k % 2 == 0;
    x.z() = isAbove ? 0.001 + 0.2 * std::abs(x.z()) : -0.001 - 0.2 * std::abs(x.z());
    Vec3 v = Vec3::Zero();
    for (int step = 1; step <= 6; ++step) {
      const Vec3 from = x;
      x = swept(collider, from, from + h * v, step * h, h);
      v = (x - from) / h;
      const Pose pose = collider.poseAt(step * h);
      const Vec3 local = pose.toLocal(x);
      if (local.head<2>().cwiseAbs().maxCoeff() < 0.15) {
        EXPECT_EQ(local.z() > 0.0, isAbove) << k << ' ' << step;
        EXPECT_GE(std::abs(local.z()), 0.001 - 1e-9);
      }
    }
  }
}

TEST(MeshSweep, AParticleSlidesOverTheEdgesOfFlatTriangles) {
  Obstacle table;
  table.shape = sheetOf(1.0, 1.0, 37, 23).shape();
  table.friction = 0.0;
  const Collider collider(table, 0.001);
  Vec3 x(-0.4, -0.31, 0.001);
  Vec3 v(1.0, 0.7, 0.0);
  const double h = 1.0 / 600.0;
  for (int step = 1; step <= 450; ++step) {
    const Vec3 from = x;
    v.z() -= 9.81 * h;
    x = swept(collider, from, from + h * v, step * h, h);
    v = (x - from) / h;
    EXPECT_NEAR(x.z(), 0.001, 1e-12);
  }
  EXPECT_NEAR(x.x(), -0.4 + 0.75, 1e-9);
  EXPECT_NEAR(v.x(), 1.0, 1e-9);
}

TEST(MeshSweep, AParticleInsideAClosedOneLeavesAtABoundedSpeed) {
  Obstacle ball;
  ball.shape = ballOf(0.1, 3).shape();
  const double h = 1.0 / 600.0;
  for (const Vec3& place : {Vec3(0.01, 0.02, 0.03), Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, -0.09)}) {
    const Collider collider(ball, 0.0005);
    Vec3 x = place;
    for (int k = 1; k <= 90; ++k) {
      const Vec3 from = x;
      x = swept(collider, from, from, k * h, h);
      EXPECT_LE((x - from).norm(), kDepenetrationSpeed * h * (1.0 + 1e-9));
      EXPECT_GE(collider.gap(x, 0.0), collider.gap(from, 0.0) - 1e-12);
    }
    EXPECT_GE(collider.gap(x, 0.0), -1e-9);
  }
}

TEST(MeshSweep, AParticleComesToRestInTheCornerOfAHollow) {
  // Two sheets in a V: it may move neither on nor through.
  SurfaceParts valley;
  valley.vertices = {{-1.0, -1.0, 0.6}, {0.0, -1.0, 0.0}, {1.0, -1.0, 0.6},
                     {-1.0, 1.0, 0.6},  {0.0, 1.0, 0.0},  {1.0, 1.0, 0.6}};
  valley.triangles = {{{0, 1, 3}}, {{1, 4, 3}}, {{1, 2, 4}}, {{2, 5, 4}}};
  Obstacle obstacle;
  obstacle.shape = valley.shape();
  obstacle.friction = 0.1;
  const Collider collider(obstacle, 0.001);
  Vec3 x(0.3, 0.1, 0.4);
  Vec3 v(0.0, 0.0, 0.0);
  const double h = 1.0 / 600.0;
  for (int step = 1; step <= 3000; ++step) {
    const Vec3 from = x;
    v.z() -= 9.81 * h;
    x = swept(collider, from, from + h * v, step * h, h);
    v = (x - from) / h;
    ASSERT_GT(x.z(), 0.6 * std::abs(x.x()));
  }
  // A substep of free fall is 2.7e-5 m; the two sides in turn take all but a tenth of it away.
  EXPECT_LT(std::abs(x.x()), 0.2 * 9.81 * h * h);
  EXPECT_LT(v.norm(), 0.2 * 9.81 * h);
}

// ---- files --------------------------------------------------------------------------------------

const char* const kTextStl =
    "solid pyramid\n"
    " facet normal 0 0 -1\n  outer loop\n   vertex 0 0 0\n   vertex 0 1 0\n   vertex 1 0 0\n"
    "  endloop\n endfacet\n"
    " facet normal 0 -1 0\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 0 1e0\n"
    "  endloop\n endfacet\n"
    " facet normal -1 0 0\n  outer loop\n   vertex 0 0 0\n   vertex 0 0 1\n   vertex 0 1 0\n"
    "  endloop\n endfacet\n"
    " facet normal 1 1 1\n  outer loop\n   vertex 1 0 0\n   vertex 0 1 0\n   vertex -0 0 1\n"
    "  endloop\n endfacet\n"
    "endsolid pyramid\n";

std::string binaryStl(const Triangles& triangles, std::uint32_t count) {
  std::string bytes(80, '\0');
  bytes.replace(0, 5, "solid");  // as some programs write
  const auto add = [&bytes](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  add(count);
  for (const auto& corners : triangles.corners) {
    for (int k = 0; k < 3; ++k) add(0.0f);
    for (const std::int32_t v : corners) {
      for (int k = 0; k < 3; ++k) add(static_cast<float>(triangles.vertices[v][k]));
    }
    add(std::uint16_t{0});
  }
  return bytes;
}

TEST(MeshFile, TextAndBinaryStlAndObjAreTheSameSolid) {
  const Triangles text = parseStl(kTextStl, "a.stl");
  EXPECT_EQ(text.vertices.size(), 4U);
  ASSERT_EQ(text.corners.size(), 4U);
  const Triangles binary = parseStl(binaryStl(text, 4), "b.stl");
  EXPECT_EQ(binary.vertices, text.vertices);
  EXPECT_EQ(binary.corners, text.corners);
  const Triangles obj = parseObjTriangles(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nf 1 3 2\nf 1//1 2//1 4//1\nf -4 -1 -2\n"
      "f 2/1 3/2 4/3\n",
      "c.obj");
  for (const Triangles& triangles : {text, binary, obj}) {
    const TriangleSurface surface(triangles.vertices, triangles.corners);
    EXPECT_TRUE(surface.isClosed());
    EXPECT_NEAR(surface.distance(Vec3(0.2, 0.2, 0.1)), -0.1, 1e-12);
  }
}

/// The error of a scene whose obstacle is the file, which must be one line.
std::string refusalOf(const std::string& file) {
  const std::string yaml =
      "cloth: {size: [1, 1], particles: [3, 3]}\nobstacles:\n  a: {type: mesh, file: " + file +
      "}\n";
  const std::string error = sceneErrorOf([&] { parseScene(yaml, "test.yaml"); });
  EXPECT_EQ(error.find('\n'), std::string::npos);
  return error;
}

std::string refusalOf(const std::string& name, const std::string& contents) {
  const SurfaceTestFile file(name, contents);
  return refusalOf(name);
}

TEST(MeshFile, BadFilesAreRefusedInOneLine) {
  const Triangles good = parseStl(kTextStl, "a.stl");
  const std::string binary = binaryStl(good, 4);
  EXPECT_THAT(refusalOf("no_such.stl"), HasSubstr("no_such.stl: "));
  EXPECT_THAT(refusalOf("mesh.ply", "ply"), HasSubstr("mesh.ply: expected a file whose name ends"));
  EXPECT_THAT(refusalOf("mesh_a.stl", ""), HasSubstr("mesh_a.stl: expected an STL file (got an"));
  EXPECT_THAT(refusalOf("mesh_b.stl", "hello"), HasSubstr("(got 5 bytes"));
  EXPECT_THAT(refusalOf("mesh_c.stl", binary.substr(0, 200)),
              HasSubstr("mesh_c.stl: expected 284 bytes, for its 4 triangles (got 200)"));
  EXPECT_THAT(refusalOf("mesh_d.stl", binaryStl(good, 1000000)),
              HasSubstr("mesh_d.stl: expected at most 200000 triangles (got 1000000)"));
  std::string nan = binary;
  const float bad = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(&nan[84 + 50 + 12], &bad, sizeof bad);
  EXPECT_THAT(refusalOf("mesh_e.stl", nan), HasSubstr("mesh_e.stl: triangle 2: expected finite"));
  EXPECT_THAT(refusalOf("mesh_f.stl", std::string(kTextStl).substr(0, 120)),
              HasSubstr("mesh_f.stl:9: expected \"facet\" or \"endsolid\" (got \"fac\")"));
  EXPECT_THAT(refusalOf("mesh_g.stl", "solid a\nfacet\nouter loop\nvertex 0 nan 0"),
              HasSubstr("mesh_g.stl:4: expected a finite number (got \"nan\")"));
  EXPECT_THAT(refusalOf("mesh_h.stl", "solid a\nendsolid a\n"),
              HasSubstr("mesh_h.stl: expected triangles with an area"));
  EXPECT_THAT(refusalOf("mesh_i.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
              HasSubstr("mesh_i.obj: expected triangles with an area (got 1 without)"));
  EXPECT_THAT(refusalOf("mesh_j.obj", "v 0 0 0\nv 1 0 0\nv 2 0 x\n"), HasSubstr("mesh_j.obj:3: "));
  EXPECT_THAT(refusalOf("mesh_k.obj", "v 0 0 0\nf 1 2 3\n"), HasSubstr("there is no vertex 2"));
  std::string many = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int k = 0; k < 200001; ++k) many += "f 1 2 3\n";
  EXPECT_THAT(refusalOf("mesh_l.obj", many), HasSubstr("expected at most 200000 triangles"));
}

TEST(MeshFile, IsRelativeToTheSceneAndInItsUnits) {
  const SurfaceTestFile file("mesh_units.stl", kTextStl);
  const Scene scene = parseScene(R"(
cloth: {size: [1, 1], particles: [3, 3]}
obstacles:
  a: {type: mesh, file: mesh_units.stl, scale: 0.001, angular_velocity: [0, 0, 2]}
)",
                                 "./test.yaml");
  const auto& mesh = std::get<MeshShape>(scene.obstacles[0].shape);
  EXPECT_EQ(mesh.file.surface->high(), Vec3(0.001, 0.001, 0.001));
  EXPECT_EQ(mesh.file.name, "mesh_units.stl");
  EXPECT_EQ(mesh.file.path.front(), '/');
  EXPECT_EQ(scene.obstacles[0].angularVelocity, Vec3(0.0, 0.0, 2.0));
}

TEST(MeshFile, ASavedStateGoesOnWithTheTrianglesOfTheScene) {
  const SurfaceTestFile file("mesh_saved.stl", kTextStl);
  const std::string text = R"(
cloth: {size: [0.5, 0.5], particles: [9, 9], pose: {position: [0.3, 0.3, 0.4]}}
obstacles: {a: {type: mesh, file: mesh_saved.stl, angular_velocity: [0, 0, 0.3]}}
)";
  Simulation one(parseScene(text, "test.yaml"));
  for (int k = 0; k < 30; ++k) one.step();
  Simulation other(parseScene(text, "test.yaml"));
  other.load(one.save());
  for (int k = 0; k < 20; ++k) {
    one.step();
    other.step();
  }
  EXPECT_FALSE(one.contacts().empty());
  EXPECT_EQ(stateHash(one.model(), one.state()), stateHash(other.model(), other.state()));
}

}  // namespace
}  // namespace cloth_sim
