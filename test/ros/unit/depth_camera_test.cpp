/// \file The image of a depth camera against closed forms, and against rays that are followed one
/// by one through the cloth and through the geometry that contact uses.

#include "ros/depth_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "ros/camera_topic.h"

namespace cloth_sim {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-9;  ///< within which an edge may be on either side [m]

CameraLens lensOf(int width, int height) {
  CameraLens lens;
  lens.width = width;
  lens.height = height;
  return lens;
}

/// A pose at `position` that looks down, with x of the image along x of the world, and is then
/// turned by `tilt` about x of the image [rad].
Pose lookingDown(const Vec3& position, double tilt = 0.0) {
  const Quat down(Eigen::AngleAxisd(M_PI, Vec3::UnitX()));
  return {position, down * Quat(Eigen::AngleAxisd(tilt, Vec3::UnitX()))};
}

/// A level n x n cloth of the given side around the origin, in a topology of its own [m].
Snapshot levelCloth(int n, double side) {
  auto topology = std::make_shared<Topology>();
  Snapshot snapshot;
  const double h = side / (n - 1);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      snapshot.positions.emplace_back(i * h - 0.5 * side, j * h - 0.5 * side, 0.0);
    }
  }
  for (int j = 0; j + 1 < n; ++j) {
    for (int i = 0; i + 1 < n; ++i) {
      const VertexId v = j * n + i;
      topology->faces.push_back({v, v + 1, v + n + 1});
      topology->faces.push_back({v, v + n + 1, v + n});
    }
  }
  snapshot.topology = topology;
  return snapshot;
}

/// The depth of the first triangle on a ray: at least `least` and at most `most`, which differ
/// where the ray passes an edge [m].
struct FirstHit {
  double least = kNowhere;
  double most = kNowhere;

  /// Solves a + u (b - a) + v (c - a) = t d for a ray d from the origin.
  void meet(const std::array<Vec3, 3>& at, const Vec3& d, double nearest) {
    Eigen::Matrix3d system;
    system << d, at[0] - at[1], at[0] - at[2];
    if (std::abs(system.determinant()) < 1e-15) return;
    const Vec3 solution = system.inverse() * at[0];
    const double t = solution[0];
    const double inside = std::min({solution[1], solution[2], 1.0 - solution[1] - solution[2]});
    if (t < nearest || inside < -kRounding) return;
    least = std::min(least, t - kRounding);
    if (inside > kRounding) most = std::min(most, t + kRounding);
  }
};

FirstHit firstHit(const Snapshot& snapshot, const Pose& camera, const Vec3& ray) {
  FirstHit hit;
  for (const Face& face : snapshot.topology->faces) {
    std::array<Vec3, 3> at;
    for (std::size_t k = 0; k < 3; ++k) at[k] = camera.toLocal(snapshot.positions[face[k]]);
    hit.meet(at, ray, CameraLens().nearest);
  }
  return hit;
}

/// Least distance of a ray from an obstacle up to `depth` [m], negative inside, by ternary search:
/// the distance from a convex solid is convex along a line.
double leastGap(const Obstacle& obstacle, const Pose& camera, const Vec3& ray, double depth) {
  return visitGeometry(obstacle.shape, obstacle.pose.orientation, 0.0, [&](const auto& solid) {
    const auto gap = [&](double t) {
      const Vec3 place = camera.toWorld(t * ray) - obstacle.pose.position;
      return solid.gap(place);
    };
    double from = 0.0;
    double to = depth;
    for (int k = 0; k < 100; ++k) {
      const double third = (to - from) / 3.0;
      if (gap(from + third) > gap(to - third)) {
        from += third;
      } else {
        to -= third;
      }
    }
    return gap(0.5 * (from + to));
  });
}

template <class Function>
void forEachPixel(const DepthCamera& camera, Function&& function) {
  auto seen = camera.seen().begin();
  for (int row = 0; row < camera.lens().height; ++row) {
    for (int column = 0; column < camera.lens().width; ++column, ++seen) {
      function(camera.ray(column, row), *seen);
    }
  }
}

/// Number of pixels that show cloth.
int countSeen(const DepthCamera& camera) {
  return static_cast<int>(std::count_if(camera.seen().begin(), camera.seen().end(),
                                        [](const SeenPoint& seen) { return seen.face != kNone; }));
}

/// The cloth of 1 m lies in the plane z = 0. The ray d of a pixel meets it at the depth
/// -height / (z component of d in the world), if that point is on the cloth.
TEST(DepthCamera, ALevelClothHasTheDepthOfItsPlane) {
  const Snapshot cloth = levelCloth(9, 1.0);
  for (const auto& [width, height] :
       {std::pair(2, 2), std::pair(320, 240), std::pair(1920, 1080)}) {
    for (const double tilt : {0.0, 0.4, -0.5}) {
      DepthCamera camera(lensOf(width, height));
      const Pose pose = lookingDown(Vec3(0.03, -0.05, 0.8), tilt);
      camera.look(pose, cloth);
      ASSERT_EQ(camera.seen().size(), static_cast<std::size_t>(width * height));
      int wrong = 0;
      forEachPixel(camera, [&](const Vec3& ray, const SeenPoint& seen) {
        const double depth = -pose.position.z() / (pose.orientation * ray).z();
        const Vec3 place = pose.toWorld(depth * ray);
        const double margin = 0.5 - std::max(std::abs(place.x()), std::abs(place.y()));
        const bool isOn = depth > 0.0 && depth < camera.lens().farthest && margin > 0.0;
        if (isOn && seen.face != kNone) {
          wrong += std::abs(seen.depth - depth) > 1e-9 ? 1 : 0;
        } else if (std::abs(margin) > kRounding) {
          wrong += isOn != (seen.face != kNone) ? 1 : 0;
        }
      });
      EXPECT_EQ(wrong, 0) << width << " x " << height << ", tilt " << tilt;
      EXPECT_GT(countSeen(camera), 0) << width << " x " << height << ", tilt " << tilt;
    }
  }
}

/// Columns and rows of pixels lie on edges of the mesh: none of them may show through.
TEST(DepthCamera, RaysAlongEdgesMeetTheCloth) {
  CameraLens lens = lensOf(65, 65);
  lens.fieldOfView = 90.0;
  DepthCamera camera(lens);
  camera.look(lookingDown(Vec3(0.0, 0.0, 0.5)), levelCloth(66, 1.0));
  EXPECT_EQ(countSeen(camera), 65 * 65);
  camera.look(lookingDown(Vec3(0.0, 0.0, 0.5)), levelCloth(3, 1.0));
  EXPECT_EQ(countSeen(camera), 65 * 65);
}

TEST(DepthCamera, OnlyDepthsFromNearestToFarthestAreSeen) {
  CameraLens lens = lensOf(40, 30);
  lens.nearest = 0.5;
  lens.farthest = 1.5;
  DepthCamera camera(lens);
  const Snapshot cloth = levelCloth(5, 8.0);
  for (const double height : {-1.0, 0.49, 1.51}) {  // behind the camera, too near, too far
    camera.look(lookingDown(Vec3(0.0, 0.0, height)), cloth);
    EXPECT_EQ(countSeen(camera), 0) << height;
  }
  camera.look(lookingDown(Vec3(0.0, 0.0, 1.0)), cloth);
  EXPECT_EQ(countSeen(camera), 40 * 30);
}

/// Triangles of 8 m go from behind the camera to beyond the largest depth.
TEST(DepthCamera, TrianglesThatReachBehindTheCameraAreSeenInPart) {
  CameraLens lens = lensOf(64, 48);
  lens.fieldOfView = 100.0;
  DepthCamera camera(lens);
  const Pose pose = lookingDown(Vec3(0.1, 0.2, 0.3), 1.3);
  const Snapshot cloth = levelCloth(2, 8.0);
  camera.look(pose, cloth);
  forEachPixel(camera, [&](const Vec3& ray, const SeenPoint& seen) {
    const FirstHit hit = firstHit(cloth, pose, ray);
    EXPECT_GE(seen.depth, hit.least);
    EXPECT_LE(seen.depth, hit.most);
  });
  EXPECT_GT(countSeen(camera), 64 * 48 / 4);
  EXPECT_LT(countSeen(camera), 64 * 48);
}

/// A cloth that hangs, bellied by wind, and is cut: compared ray by ray.
TEST(DepthCamera, ACutClothIsSeenAsRaysMeetIt) {
  Simulation simulation(parseScene(R"(
cloth: {size: [0.3, 0.3], particles: [12, 12], pins: [corner_00, corner_10, corner_01]}
wind: {velocity: [3.0, 2.0, 5.0]}
)",
                                   "test"));
  const Stroke middle =
      strokeAlong({Vec3(-1.0, 0.02, 0.0), Vec3(1.0, 0.05, 0.0)}, Vec3::UnitZ(), 1.0);
  ASSERT_TRUE(simulation.apply(CutAlong{middle}).success);
  for (int k = 0; k < 30; ++k) simulation.step();
  const auto snapshot = simulation.snapshot();
  const Pose pose = lookingDown(Vec3(0.0, 0.1, 0.5), 0.3);
  DepthCamera camera(lensOf(80, 60));
  camera.look(pose, *snapshot);
  forEachPixel(camera, [&](const Vec3& ray, const SeenPoint& seen) {
    const FirstHit hit = firstHit(*snapshot, pose, ray);
    EXPECT_GE(seen.depth, hit.least);
    EXPECT_LE(seen.depth, hit.most);
  });
  EXPECT_GT(countSeen(camera), 80 * 60 / 10);
  EXPECT_LT(countSeen(camera), 80 * 60);
}

Obstacle obstacleOf(const Shape& shape, const Pose& pose) {
  Obstacle obstacle;
  obstacle.name = "obstacle";
  obstacle.shape = shape;
  obstacle.pose = pose;
  return obstacle;
}

/// Obstacles between camera and cloth, turned against all axes.
std::vector<Obstacle> convexObstacles() {
  const Pose pose{Vec3(0.05, -0.02, 0.3),
                  Quat(Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -0.5).normalized()))};
  std::vector<Obstacle> all;
  for (const Shape& shape : {Shape(SphereShape{0.1}), Shape(BoxShape{Vec3(0.2, 0.1, 0.05)}),
                             Shape(CapsuleShape{0.05, 0.2}), Shape(CylinderShape{0.05, 0.2})}) {
    all.push_back(obstacleOf(shape, pose));
  }
  return all;
}

/// Number of pixels that differ from what rays say, with one obstacle between camera and cloth.
int countWrong(const DepthCamera& camera, const Pose& pose, const Obstacle& obstacle) {
  int wrong = 0;
  forEachPixel(camera, [&](const Vec3& ray, const SeenPoint& seen) {
    const double depth = -pose.position.z() / (pose.orientation * ray).z();
    const double gap = leastGap(obstacle, pose, ray, depth);
    if (std::abs(gap) < kRounding) return;
    wrong += (gap < 0.0) != (seen.face == kNone) ? 1 : 0;
  });
  return wrong;
}

TEST(DepthCamera, ObstaclesHideWhatTheirGeometryHides) {
  Snapshot cloth = levelCloth(9, 4.0);
  for (const Obstacle& obstacle : convexObstacles()) {
    cloth.obstacles = {obstacle};
    for (const double tilt : {0.0, 0.25}) {
      DepthCamera camera(lensOf(80, 60));
      const Pose pose = lookingDown(Vec3(0.0, 0.1, 0.9), tilt);
      camera.look(pose, cloth);
      EXPECT_EQ(countWrong(camera, pose, obstacle), 0) << typeNames(obstacle.shape)[0];
      EXPECT_LT(countSeen(camera), 80 * 60 - 50) << typeNames(obstacle.shape)[0];
      EXPECT_GT(countSeen(camera), 80 * 60 / 2) << typeNames(obstacle.shape)[0];
    }
  }
}

TEST(DepthCamera, WhatLiesBehindTheClothHidesNothing) {
  Snapshot cloth = levelCloth(9, 4.0);
  for (Obstacle& obstacle : convexObstacles()) {
    obstacle.pose.position.z() = -0.3;
    cloth.obstacles = {obstacle, obstacleOf(BoundsShape{Vec3::Constant(0.5)}, Pose())};
    DepthCamera camera(lensOf(80, 60));
    camera.look(lookingDown(Vec3(0.0, 0.1, 0.9)), cloth);
    EXPECT_EQ(countSeen(camera), 80 * 60) << typeNames(obstacle.shape)[0];
  }
}

/// The default mesh is a cube of 0.2 m, so it hides what a box of that size does.
TEST(DepthCamera, AMeshHidesAsTheSolidDoes) {
  Snapshot cloth = levelCloth(9, 4.0);
  const Pose place = convexObstacles()[0].pose;
  const Obstacle box = obstacleOf(BoxShape{Vec3::Constant(0.2)}, place);
  cloth.obstacles = {obstacleOf(MeshShape(), place)};
  DepthCamera camera(lensOf(80, 60));
  const Pose pose = lookingDown(Vec3(0.0, 0.1, 0.9), 0.1);
  camera.look(pose, cloth);
  EXPECT_EQ(countWrong(camera, pose, box), 0);
  EXPECT_LT(countSeen(camera), 80 * 60 - 200);
}

/// One triangle in space, seen from in front and from behind.
TEST(DepthCamera, AnOpenMeshHidesFromBothSides) {
  const std::vector<Vec3> corners{Vec3(-0.1, -0.1, 0.0), Vec3(0.2, 0.0, 0.05), Vec3(0.0, 0.2, 0.0)};
  const Pose pose = lookingDown(Vec3(0.0, 0.1, 0.9));
  DepthCamera camera(lensOf(80, 60));
  for (const TriangleSurface::Triangle& triangle :
       {TriangleSurface::Triangle{0, 1, 2}, TriangleSurface::Triangle{0, 2, 1}}) {
    MeshShape mesh;
    mesh.file = surfaceFile("triangle", TriangleSurface(corners, {triangle}));
    Snapshot cloth = levelCloth(9, 4.0);
    cloth.obstacles = {obstacleOf(mesh, {Vec3(0.0, 0.0, 0.4), Quat::Identity()})};
    camera.look(pose, cloth);
    int wrong = 0;
    forEachPixel(camera, [&](const Vec3& ray, const SeenPoint& seen) {
      FirstHit hit;
      std::array<Vec3, 3> at;
      for (std::size_t k = 0; k < 3; ++k) {
        at[k] = pose.toLocal(cloth.obstacles[0].pose.toWorld(corners[k]));
      }
      hit.meet(at, ray, camera.lens().nearest);
      if (std::isfinite(hit.least) != std::isfinite(hit.most)) return;  // on an edge
      wrong += std::isfinite(hit.most) != (seen.face == kNone) ? 1 : 0;
    });
    EXPECT_EQ(wrong, 0);
    EXPECT_LT(countSeen(camera), 80 * 60 - 200);
  }
}

/// A camera in its own case: the case does not blind it, whatever its form.
TEST(DepthCamera, ACameraWithinASolidSeesOutOfIt) {
  Snapshot cloth = levelCloth(9, 4.0);
  const Pose pose = lookingDown(Vec3(0.0, 0.1, 0.9));
  for (const Shape& shape :
       {Shape(SphereShape{0.1}), Shape(BoxShape{Vec3(0.2, 0.1, 0.05)}),
        Shape(CapsuleShape{0.05, 0.2}), Shape(CylinderShape{0.05, 0.2}), Shape(MeshShape())}) {
    cloth.obstacles = {obstacleOf(shape, pose)};
    DepthCamera camera(lensOf(80, 60));
    camera.look(pose, cloth);
    EXPECT_EQ(countSeen(camera), 80 * 60) << typeNames(shape)[0];
  }
}

TEST(DepthCamera, TheNearerOfTwoLayersIsSeen) {
  Snapshot cloth = levelCloth(3, 4.0);
  auto topology = std::make_shared<Topology>(*cloth.topology);
  topology->faces.insert(topology->faces.begin(), {{9, 10, 11}});
  cloth.topology = topology;
  cloth.positions.insert(cloth.positions.end(),
                         {Vec3(-9.0, -9.0, 0.2), Vec3(9.0, -9.0, 0.2), Vec3(0.0, 9.0, 0.2)});
  DepthCamera camera(lensOf(20, 20));
  camera.look(lookingDown(Vec3(0.0, 0.0, 1.0)), cloth);
  for (const SeenPoint& seen : camera.seen()) EXPECT_EQ(seen.face, 0);
  camera.look({Vec3(0.0, 0.0, -1.0), Quat::Identity()}, cloth);
  for (const SeenPoint& seen : camera.seen()) EXPECT_GT(seen.face, 0);
}

TEST(DepthCamera, PositionsThatAreNotFiniteAreNotSeen) {
  for (const double bad : {kNowhere, std::numeric_limits<double>::quiet_NaN()}) {
    Snapshot cloth = levelCloth(2, 4.0);
    cloth.positions[1].x() = bad;  // of the first of two triangles
    DepthCamera camera(lensOf(20, 20));
    camera.look(lookingDown(Vec3(0.0, 0.0, 1.0)), cloth);
    for (const SeenPoint& seen : camera.seen()) EXPECT_NE(seen.face, 0);
    EXPECT_GT(countSeen(camera), 0);
  }
}

/// The right half of the image shows one triangle of strain 0.25; the left half shows nothing.
TEST(DepthCamera, TheCloudHasThePixelsInTheirOrder) {
  auto topology = std::make_shared<Topology>();
  topology->faces = {{0, 1, 2}};
  Snapshot snapshot;
  snapshot.topology = topology;
  snapshot.positions = {Vec3(0.0, -9.0, 2.0), Vec3(18.0, 0.0, 2.0), Vec3(0.0, 9.0, 2.0)};
  DepthCamera camera(lensOf(4, 3));
  camera.look(Pose(), snapshot);
  sensor_msgs::PointCloud2 cloud;
  fillCameraPoints(camera, topology->faces, {0.1f, 0.25f, 0.0f}, cloud);
  EXPECT_EQ(cloud.width, 4u);
  EXPECT_EQ(cloud.height, 3u);
  EXPECT_EQ(cloud.data.size(), 4u * 3u * 4u * sizeof(float));
  EXPECT_EQ(cloud.row_step, 4u * 4u * sizeof(float));
  EXPECT_FALSE(cloud.is_dense);
  sensor_msgs::PointCloud2ConstIterator<float> at(cloud, "x");
  const double focal = 2.0 / std::tan(M_PI / 6.0);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column, ++at) {
      if (column < 2) {
        for (int k = 0; k < 4; ++k) EXPECT_TRUE(std::isnan(at[k])) << row << " " << column;
        continue;
      }
      EXPECT_NEAR(at[0], 2.0 * (column - 1.5) / focal, 1e-6);
      EXPECT_NEAR(at[1], 2.0 * (row - 1.0) / focal, 1e-6);
      EXPECT_NEAR(at[2], 2.0, 1e-6);
      EXPECT_EQ(at[3], 0.25f);
    }
  }
}

}  // namespace
}  // namespace cloth_sim
