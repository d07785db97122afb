#include "cloth_sim/contact/collider.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>

namespace cloth_sim {
namespace {

Vec3 randomPoint(std::mt19937& random, double range) {
  std::uniform_real_distribution<double> coordinate(-range, range);
  const double x = coordinate(random);
  const double y = coordinate(random);
  return Vec3(x, y, coordinate(random));
}

Obstacle obstacle(Shape shape) {
  Obstacle result;
  result.name = "thing";
  result.shape = std::move(shape);
  result.pose.position = Vec3(0.1, -0.2, 0.3);
  result.pose.orientation = Quat(Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -0.5).normalized()));
  return result;
}

const Vec3 kSize(0.8, 0.5, 0.1);
const double kMargin = 0.004;

/// A collider of each shape with its default dimensions, and some with others.
std::vector<Collider> oneOfEach(double margin = kMargin) {
  std::vector<Shape> shapes{SphereShape{0.3}, CapsuleShape{0.1, 0.4}, BoxShape{kSize},
                            BoundsShape{Vec3(1.0, 0.8, 0.9)}};
  shapes.insert(shapes.end(), allShapes().begin(), allShapes().end());
  std::vector<Collider> colliders;
  for (const Shape& shape : shapes) colliders.emplace_back(obstacle(shape), margin);
  return colliders;
}

/// Distance to the surface of a box, by looking at a fine grid of points on its six faces.
double sampledDistanceToBoxSurface(const Vec3& p, const Vec3& half, int samples) {
  double nearest2 = std::numeric_limits<double>::infinity();
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const int a = (axis + 1) % 3;
    const int b = (axis + 2) % 3;
    Vec3 q;
    q[axis] = face % 2 ? half[axis] : -half[axis];
    for (int i = 0; i <= samples; ++i) {
      q[a] = half[a] * (2.0 * i / samples - 1.0);
      for (int j = 0; j <= samples; ++j) {
        q[b] = half[b] * (2.0 * j / samples - 1.0);
        nearest2 = std::min(nearest2, (p - q).squaredNorm());
      }
    }
  }
  return std::sqrt(nearest2);
}

TEST(Collider, GapOfPlaneIsTheHeightAlongItsZ) {
  const Collider plane(obstacle(PlaneShape{}), kMargin);
  const Pose pose = plane.poseAt(0.0);
  EXPECT_NEAR(plane.gap(pose.toWorld(Vec3(3.0, -7.0, 0.25)), 0.0), 0.25 - kMargin, 1e-14);
  EXPECT_NEAR(plane.gap(pose.toWorld(Vec3(3.0, -7.0, -0.25)), 0.0), -0.25 - kMargin, 1e-14);
}

TEST(Collider, GapOfSphereIsTheDistanceLessItsRadius) {
  const Collider sphere(obstacle(SphereShape{0.3}), kMargin);
  const Pose pose = sphere.poseAt(0.0);
  EXPECT_NEAR(sphere.gap(pose.toWorld(Vec3(0.3, 0.4, 0.0)), 0.0), 0.2 - kMargin, 1e-14);
  EXPECT_NEAR(sphere.gap(pose.position, 0.0), -0.3 - kMargin, 1e-14);
}

TEST(Collider, GapOfBoxAndBoundsMatchesASampledSurface) {
  const Collider box(obstacle(BoxShape{kSize}), kMargin);
  const Collider bounds(obstacle(BoundsShape{kSize}), kMargin);
  const Vec3 half = 0.5 * kSize;
  const int samples = 100;
  // The nearest sample is at most half a sample's cell off, and the distance at most that.
  const double coarse = 0.5 * std::hypot(kSize.x(), kSize.y()) / samples;
  std::mt19937 random(7);
  for (int k = 0; k < 100; ++k) {
    const Vec3 local = randomPoint(random, 0.5);
    const double distance = sampledDistanceToBoxSurface(local, half, samples);
    const bool inside = (local.cwiseAbs() - half).maxCoeff() < 0.0;
    const double outward = inside ? -distance : distance;
    const Vec3 world = box.poseAt(0.0).toWorld(local);
    EXPECT_NEAR(box.gap(world, 0.0), outward - kMargin, coarse);
    EXPECT_NEAR(bounds.gap(world, 0.0), -outward - kMargin, coarse);
  }
}

TEST(Collider, NormalIsTheGradientOfTheGap) {
  // Central differences of a distance with curvature radius >= r err by h^2 / (2 r^2) at most; the
  // points nearer than 1 mm to where two features are equally close are left out, by looking
  // whether the one-sided differences agree.
  const double h = 1e-6;
  std::mt19937 random(11);
  for (const Collider& collider : oneOfEach()) {
    int compared = 0;
    for (int k = 0; k < 300; ++k) {
      const Vec3 p = collider.poseAt(0.0).toWorld(randomPoint(random, 0.5));
      Vec3 forward, backward;
      for (int a = 0; a < 3; ++a) {
        const double here = collider.gap(p, 0.0);
        forward[a] = (collider.gap(p + h * Vec3::Unit(a), 0.0) - here) / h;
        backward[a] = (here - collider.gap(p - h * Vec3::Unit(a), 0.0)) / h;
      }
      if ((forward - backward).norm() > 1e-2) continue;
      EXPECT_LT((collider.normal(p, 0.0) - 0.5 * (forward + backward)).norm(), 1e-6);
      ++compared;
    }
    EXPECT_GT(compared, 280);
  }
}

TEST(Collider, NormalTurnsContinuouslyAroundTheEdgeOfABoard) {
  Obstacle board;
  board.shape = BoxShape{Vec3(1.0, 1.0, 0.1)};
  const Collider collider(board, 0.01);
  // A quarter turn around the edge at the inflated surface, in 1000 steps.
  Vec3 last = Vec3::UnitZ();
  for (int k = 0; k <= 1000; ++k) {
    const double angle = 0.5 * M_PI * k / 1000.0;
    const Vec3 offset(std::sin(angle), 0.0, std::cos(angle));
    const Vec3 p = Vec3(0.5, 0.2, 0.05) + 0.01 * offset;
    EXPECT_NEAR(collider.gap(p, 0.0), 0.0, 1e-15);
    const Vec3 normal = collider.normal(p, 0.0);
    EXPECT_LT((normal - last).norm(), 2e-3);
    last = normal;
  }
  EXPECT_LT((last - Vec3::UnitX()).norm(), 1e-12);
}

TEST(Collider, GapOfCapsuleIsTheDistanceToItsSegmentLessItsRadius) {
  const Collider capsule(obstacle(CapsuleShape{0.1, 0.4}), kMargin);
  const Pose pose = capsule.poseAt(0.0);
  const auto gapAt = [&](const Vec3& local) { return capsule.gap(pose.toWorld(local), 0.0); };
  EXPECT_NEAR(gapAt(Vec3(0.3, 0.4, 0.15)), 0.5 - 0.1 - kMargin, 1e-14) << "beside it";
  EXPECT_NEAR(gapAt(Vec3(0.0, 0.3, 0.6)), 0.5 - 0.1 - kMargin, 1e-14) << "beyond its end";
  EXPECT_NEAR(gapAt(Vec3(0.0, 0.0, 0.1)), -0.1 - kMargin, 1e-14) << "on its axis";
  const Vec3 inside = pose.toWorld(Vec3(0.0, 0.0, 0.1));
  EXPECT_NEAR(capsule.normal(inside, 0.0).norm(), 1.0, 1e-14);
  EXPECT_NEAR(capsule.normal(inside, 0.0).dot(pose.orientation * Vec3::UnitZ()), 0.0, 1e-14);
}

TEST(Collider, MovesWithItsVelocityFromWhereItWasPlaced) {
  Collider sphere(obstacle(SphereShape{0.3}), 0.0);
  Pose pose;
  pose.position = Vec3(1.0, 0.0, 0.0);
  sphere.place(pose, Vec3(0.0, 2.0, 0.0), 5.0);
  EXPECT_EQ(sphere.poseAt(5.0).position, Vec3(1.0, 0.0, 0.0));
  EXPECT_EQ(sphere.poseAt(5.5).position, Vec3(1.0, 1.0, 0.0));
  EXPECT_NEAR(sphere.gap(Vec3(1.0, 1.0, 1.0), 5.5), 0.7, 1e-15);
}

/// Points on the surface of a primitive, in the axes of the shape [m].
std::vector<Vec3> surfaceOf(const DrawnPart& part) {
  std::vector<Vec3> points;
  for (const double u : {-0.5, 0.0, 0.5}) {
    for (const double angle : {0.3, 1.2, 2.9, 4.0, 5.5}) {
      const Vec3 around(0.5 * std::cos(angle), 0.5 * std::sin(angle), 0.0);
      switch (part.kind) {
        case DrawnPart::Kind::kBox:
          points.push_back(Vec3(u, 0.5, -0.3));
          points.push_back(Vec3(-0.2, u, 0.5));
          points.push_back(Vec3(-0.5, 0.1, u));
          break;
        case DrawnPart::Kind::kSphere:
          points.push_back(std::sqrt(1.0 - 4.0 * u * u) * around + u * Vec3::UnitZ());
          break;
        case DrawnPart::Kind::kCylinder:
          points.push_back(around + u * Vec3::UnitZ());
          break;
        case DrawnPart::Kind::kBoxEdges:
          points.push_back(Vec3(u, 0.5, -0.5));
          break;
        case DrawnPart::Kind::kTriangles:
          points = part.surface->vertices();
          break;
      }
    }
  }
  for (Vec3& point : points) point = part.centre + point.cwiseProduct(part.size);
  return points;
}

TEST(Collider, DrawingsAreInTheSolidAndReachItsSurface) {
  for (const Collider& collider : oneOfEach(0.0)) {
    SCOPED_TRACE(typeNames(collider.obstacle().shape).front());
    double farthest = -std::numeric_limits<double>::infinity();
    for (const DrawnPart& part : drawing(collider.obstacle().shape)) {
      for (const Vec3& point : surfaceOf(part)) {
        farthest = std::max(farthest, collider.gap(collider.poseAt(0.0).toWorld(point), 0.0));
      }
    }
    EXPECT_NEAR(farthest, 0.0, 1e-12);
  }
}

TEST(Collider, HandlesFitIntoTheSolid) {
  for (const Collider& collider : oneOfEach(0.0)) {
    const std::optional<double> radius = handleRadius(collider.obstacle().shape);
    if (!radius) continue;
    EXPECT_LE(collider.gap(collider.poseAt(0.0).position, 0.0), -*radius + 1e-12)
        << typeNames(collider.obstacle().shape).front();
  }
}

TEST(Collider, BadDimensionsAreNamed) {
  EXPECT_EQ(validationError(CapsuleShape{0.1, 0.4}), "");
  EXPECT_EQ(validationError(CapsuleShape{0.1, -0.4}), "length: expected a length > 0");
}

TEST(Collider, RefusesNonsense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Collider(obstacle(SphereShape{0.0}), 0.0), std::invalid_argument);
  EXPECT_THROW(Collider(obstacle(SphereShape{nan}), 0.0), std::invalid_argument);
  EXPECT_THROW(Collider(obstacle(CapsuleShape{0.1, 0.0}), 0.0), std::invalid_argument);
  EXPECT_THROW(Collider(obstacle(CapsuleShape{-0.1, 1.0}), 0.0), std::invalid_argument);
  EXPECT_THROW(Collider(obstacle(BoxShape{Vec3(1.0, -1.0, 1.0)}), 0.0), std::invalid_argument);
  EXPECT_THROW(Collider(obstacle(BoundsShape{Vec3::Zero()}), 0.0), std::invalid_argument);
  EXPECT_THROW(Collider(obstacle(PlaneShape{}), -1e-3), std::invalid_argument);
  Obstacle rough = obstacle(PlaneShape{});
  rough.friction = -0.1;
  EXPECT_THROW(Collider(rough, 0.0), std::invalid_argument);
  rough.friction = 0.1;
  rough.tangentialDecay = nan;
  EXPECT_THROW(Collider(rough, 0.0), std::invalid_argument);
}

/// A cloud of particles that fly in all directions.
State randomState(int count, double range, double speed) {
  std::mt19937 random(23);
  State state;
  state.x = VertexData<Vec3>(static_cast<std::size_t>(count), Vec3::Zero());
  state.v = state.x;
  for (int v = 0; v < count; ++v) {
    state.x[v] = randomPoint(random, range);
    state.v[v] = randomPoint(random, speed);
  }
  state.t = 2.0;
  return state;
}

TEST(ColliderDetection, FindsExactlyWhatCanReachTheSurface) {
  const State state = randomState(2000, 1.0, 3.0);
  const double dt = 1.0 / 60.0;
  const double reach = 0.005;
  for (Collider& collider : oneOfEach()) {
    const Vec3 velocity(0.5, -1.0, 0.25);
    collider.place(collider.obstacle().pose, velocity, 1.5);
    std::vector<VertexId> expected;
    for (VertexId v = 0; v < 2000; ++v) {
      const double travel = reach + dt * (state.v[v] - velocity).norm();
      if (collider.gap(state.x[v], state.t) <= travel) expected.push_back(v);
    }
    std::vector<VertexId> found;
    collider.collect(state, dt, reach, found);
    EXPECT_EQ(found, expected);
    EXPECT_FALSE(found.empty());
    EXPECT_LT(found.size(), 2000u);
  }
}

TEST(ColliderDetection, BoundsAreThoseOfAllParticles) {
  for (const std::size_t count : {1, 2, 7, 8}) {
    const State state = randomState(count, 1.0, 3.0);
    Vec3 low = state.x[0];
    Vec3 high = state.x[0];
    double speed = 0.0;
    for (VertexId v = 0; v < static_cast<VertexId>(count); ++v) {
      low = low.cwiseMin(state.x[v]);
      high = high.cwiseMax(state.x[v]);
      speed = std::max(speed, state.v[v].norm());
    }
    const MotionBounds bounds = motionBounds(state);
    EXPECT_EQ(bounds.centre, 0.5 * (low + high));
    EXPECT_EQ(bounds.half, 0.5 * (high - low));
    EXPECT_EQ(bounds.speed, speed);
  }
  EXPECT_EQ(motionBounds(State()).speed, 0.0);
}

TEST(ColliderDetection, ListsOnlyCollidersWithSomethingNear) {
  State state = randomState(100, 0.1, 0.0);
  ColliderSet set;
  Obstacle far = obstacle(SphereShape{0.1});
  far.name = "far";
  far.pose.position = Vec3(5.0, 0.0, 0.0);
  set.add(far, 0.0);
  Obstacle ground = obstacle(PlaneShape{});
  ground.name = "ground";
  ground.pose = Pose();
  set.add(ground, 0.0);
  Contacts contacts;
  set.detect(state, 0.01, 0.0, contacts);
  ASSERT_EQ(contacts.candidates.size(), 1u);
  EXPECT_EQ(contacts.candidates[0].collider, set.find("ground"));
  EXPECT_TRUE(std::is_sorted(contacts.candidates[0].vertices.begin(),
                             contacts.candidates[0].vertices.end()));
  EXPECT_EQ(set.find("nothing"), nullptr);

  set.detect(State(), 0.01, 0.0, contacts);
  EXPECT_TRUE(contacts.empty());
}

TEST(ColliderDetection, KeepsItsMemoryFromStepToStep) {
  State state = randomState(100, 0.1, 0.0);
  State away = state;
  for (Vec3& x : away.x) x.z() += 10.0;
  ColliderSet set;
  Obstacle ground = obstacle(PlaneShape{});
  ground.pose = Pose();
  set.add(ground, 0.0);
  Contacts contacts;
  set.detect(state, 0.01, 0.0, contacts);
  ASSERT_EQ(contacts.candidates.size(), 1u);
  const VertexId* memory = contacts.candidates[0].vertices.data();
  contacts.candidates[0].impulse.linear = Vec3::Ones();
  set.detect(away, 0.01, 0.0, contacts);
  EXPECT_TRUE(contacts.empty());
  set.detect(state, 0.01, 0.0, contacts);
  ASSERT_EQ(contacts.candidates.size(), 1u);
  EXPECT_EQ(contacts.candidates[0].vertices.data(), memory);
  EXPECT_EQ(contacts.candidates[0].impulse.linear, Vec3::Zero());
}

}  // namespace
}  // namespace cloth_sim
