/// \file Single particles against obstacles, integrated by hand the way that every solver does it:
/// v += g h; x* = x + v h; project; v = (x - start) / h. What is expected is Coulomb's law and
/// mechanics; each tolerance says which discretisation it stands for.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <variant>

#include "cloth_sim/contact/collider.h"
#include "cloth_sim/threads/thread_limit.h"
#include "cloth_sim/threads/thread_pool.h"

namespace cloth_sim {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]

struct Particle {
  Vec3 x = Vec3::Zero();
  Vec3 v = Vec3::Zero();
  double mass = 0.01;
  double t = 0.0;
};

/// Contacts of the one particle with the one collider.
Contacts contactsWith(const Collider& collider) {
  Contacts contacts;
  contacts.add(&collider).vertices.push_back(0);
  return contacts;
}

/// Moves from `start` to `end` in one substep, and returns where contact lets it end.
Vec3 projected(Contacts& contacts, const Vec3& start, const Vec3& end, double mass, double time,
               double h) {
  Vec3 x = end;
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

void substep(Particle& particle, Contacts& contacts, double h,
             const Vec3& gravity = Vec3(0.0, 0.0, -kGravity)) {
  const Vec3 start = particle.x;
  const Vec3 free = start + (particle.v + gravity * h) * h;
  particle.t += h;
  particle.x = projected(contacts, start, free, particle.mass, particle.t, h);
  particle.v = (particle.x - start) / h;
}

Collider incline(double angle, double friction) {
  Obstacle plane;
  plane.pose.orientation = Quat(Eigen::AngleAxisd(angle, Vec3(1.0, 2.0, 0.0).normalized()));
  plane.friction = friction;
  return Collider(plane, 0.001);
}

// ---- tunnelling ---------------------------------------------------------------------------------

/// Shoots particles at a collider from all around in one substep of 1/60 s, along lines through
/// points of the solid, and expects none of them inside or beyond. At least `leastShots` must have
/// begun outside.
void expectNothingPasses(const Collider& collider, const std::vector<Vec3>& insidePoints,
                         double speed, int leastShots = 500) {
  const double h = 1.0 / 60.0;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> fraction(0.05, 0.95);
  int shots = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vec3& through = insidePoints[static_cast<std::size_t>(k) % insidePoints.size()];
    const double nx = normal(random), ny = normal(random), nz = normal(random);
    const Vec3 direction = Vec3(nx, ny, nz).normalized();
    const Vec3 start = through - fraction(random) * speed * h * direction;
    if (collider.gap(start, 0.0) < 0.0) continue;
    ++shots;
    Contacts contacts = contactsWith(collider);
    const Vec3 end = projected(contacts, start, start + speed * h * direction, 0.01, h, h);
    // The entry is found to 1e-9 m and the end held to the tangent plane there, so the gap is right
    // to the second order of that, and to round-off.
    EXPECT_GE(collider.gap(end, h), -1e-12);
    // On this side: the solid does not lie between start and end.
    for (double s = 0.0; s <= 1.0; s += 0.01) {
      EXPECT_GE(collider.gap(start + s * (end - start), h), -1e-9);
    }
  }
  EXPECT_GT(shots, leastShots);
}

class ContactTunnelling : public testing::TestWithParam<double> {};

TEST_P(ContactTunnelling, NotThroughAThinBoard) {
  Obstacle board;
  board.shape = BoxShape{Vec3(0.6, 0.4, 0.002)};
  board.pose.orientation = Quat(Eigen::AngleAxisd(0.4, Vec3(1.0, 1.0, 0.3).normalized()));
  board.friction = 0.0;
  std::vector<Vec3> inside{Vec3::Zero()};
  for (const Vec3& p : {Vec3(0.299, 0.0, 0.0), Vec3(0.1, 0.199, 0.0005), Vec3(-0.299, -0.199, 0.0)})
    inside.push_back(board.pose.toWorld(p));
  expectNothingPasses(Collider(board, 0.0), inside, GetParam());
  expectNothingPasses(Collider(board, 0.001), inside, GetParam());
}

TEST_P(ContactTunnelling, NotThroughASphere) {
  Obstacle sphere;
  sphere.shape = SphereShape{0.02};
  sphere.friction = 0.0;
  expectNothingPasses(Collider(sphere, 0.001), {Vec3::Zero(), Vec3(0.0, 0.015, 0.01)}, GetParam());
}

TEST_P(ContactTunnelling, NotThroughACapsule) {
  Obstacle rod;
  rod.shape = CapsuleShape{0.01, 0.2};
  rod.pose.orientation = Quat(Eigen::AngleAxisd(0.8, Vec3(1.0, -1.0, 0.5).normalized()));
  rod.friction = 0.0;
  std::vector<Vec3> inside;
  for (const Vec3& p : {Vec3(0.0, 0.0, 0.0), Vec3(0.005, 0.0, 0.09), Vec3(0.0, 0.004, -0.105)}) {
    inside.push_back(rod.pose.toWorld(p));
  }
  expectNothingPasses(Collider(rod, 0.0), inside, GetParam());
  expectNothingPasses(Collider(rod, 0.001), inside, GetParam());
}

TEST_P(ContactTunnelling, NotThroughAPlane) {
  expectNothingPasses(incline(0.3, 0.0), {Vec3(0.0, 0.0, -0.01)}, GetParam());
}

/// Random points of the solid at most `depth` below its surface [m].
std::vector<Vec3> pointsBelowSurface(const Collider& collider, double depth) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(-0.7, 0.7);
  std::vector<Vec3> points;
  while (points.size() < 100) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    const double gap = collider.gap(Vec3(x, y, z), 0.0);
    if (gap < 0.0 && gap > -depth) points.emplace_back(x, y, z);
  }
  return points;
}

TEST_P(ContactTunnelling, NotThroughAnyShape) {
  for (const Shape& shape : allShapes()) {
    SCOPED_TRACE(typeNames(shape).front());
    Obstacle obstacle;
    obstacle.shape = shape;
    obstacle.pose.orientation = Quat(Eigen::AngleAxisd(0.8, Vec3(1.0, -1.0, 0.5).normalized()));
    obstacle.friction = 0.0;
    const Collider collider(obstacle, 0.001);
    // Bounds are solid all around: many of the random starts lie in them.
    const int leastShots = std::holds_alternative<BoundsShape>(shape) ? 100 : 500;
    expectNothingPasses(collider, pointsBelowSurface(collider, 0.02), GetParam(), leastShots);
  }
}

INSTANTIATE_TEST_SUITE_P(Speeds, ContactTunnelling, testing::Values(20.0, 200.0));

TEST(ContactBounds, KeepAFastParticleInside) {
  Obstacle bounds;
  bounds.shape = BoundsShape{Vec3(1.6, 1.6, 1.6)};
  const Collider collider(bounds, 0.0);
  Contacts contacts = contactsWith(collider);
  const double h = 1.0 / 60.0;
  const Vec3 end = projected(contacts, Vec3(0.7, 0.7, 0.0), Vec3(3.0, 4.0, 0.1), 0.01, h, h);
  EXPECT_GE(collider.gap(end, h), -1e-15);
  // A wall that it has not reached does not hold it.
  const Vec3 within(0.75, 0.7, 0.0);
  EXPECT_EQ(projected(contacts, Vec3(0.7, 0.7, 0.0), within, 0.01, h, h), within);
}

TEST(ContactTunnellingMoving, AFastSphereDoesNotPassAParticleAtRest) {
  Obstacle sphere;
  sphere.shape = SphereShape{0.02};
  sphere.pose.position = Vec3(-0.2, 0.001, 0.0);
  sphere.velocity = Vec3(40.0, 0.0, 0.0);
  const Collider collider(sphere, 0.0);
  Contacts contacts = contactsWith(collider);
  const double h = 1.0 / 60.0;
  const Vec3 end = projected(contacts, Vec3::Zero(), Vec3::Zero(), 0.01, h, h);
  EXPECT_GE(collider.gap(end, h), -1e-12);
  EXPECT_GT(end.x(), collider.poseAt(h).position.x());  // in front of it, not behind
}

// ---- friction -----------------------------------------------------------------------------------

TEST(ContactFriction, SticksExactlyBelowTheAngleOfFriction) {
  const double mu = 0.3;
  for (const double tilt : {0.0, 0.5, 0.99}) {
    const Collider plane = incline(tilt * std::atan(mu), mu);
    Contacts contacts = contactsWith(plane);
    Particle particle;
    particle.x = 0.001 * plane.normal(Vec3::Zero(), 0.0);
    const double h = 1.0 / 600.0;
    substep(particle, contacts, h);
    const Vec3 settled = particle.x;
    for (int k = 0; k < 60 * 600; ++k) substep(particle, contacts, h);
    EXPECT_EQ(particle.x, settled);  // to the last bit, for 60 s
    EXPECT_EQ(particle.v, Vec3::Zero());
  }
}

TEST(ContactFriction, SlidesWithTheRestOfGravityAboveTheAngleOfFriction) {
  const double mu = 0.3;
  const double angle = 0.5;
  const Collider plane = incline(angle, mu);
  Contacts contacts = contactsWith(plane);
  Particle particle;
  particle.x = 0.001 * plane.normal(Vec3::Zero(), 0.0);
  const double h = 1.0 / 600.0;
  for (int k = 0; k < 600; ++k) substep(particle, contacts, h);
  // Each substep adds (sin - mu cos) g h to the speed, exactly.
  const double expected = kGravity * (std::sin(angle) - mu * std::cos(angle));
  EXPECT_NEAR(particle.v.norm(), expected, 1e-10);
}

TEST(ContactFriction, SlidingStopsAfterTheDistanceOfCoulombsLaw) {
  const double mu = 0.4;
  const double speed = 2.0;
  const Collider plane = incline(0.0, mu);
  for (const double h : {1.0 / 60.0, 1.0 / 600.0}) {
    Contacts contacts = contactsWith(plane);
    Particle particle;
    particle.x = Vec3(0.0, 0.0, 0.001);
    particle.v = Vec3(speed, 0.0, 0.0);
    for (double t = 0.0; t < 1.0; t += h) substep(particle, contacts, h);
    // Symplectic Euler brakes before it moves: short by v h / 2, and by mu g h^2 for the last step.
    const double expected = speed * speed / (2.0 * mu * kGravity);
    EXPECT_NEAR(particle.x.x(), expected - 0.5 * speed * h, mu * kGravity * h * h);
    EXPECT_EQ(particle.v, Vec3::Zero());
  }
}

TEST(ContactFriction, TangentialDecayAloneIsExponential) {
  Obstacle table;
  table.friction = 0.0;
  table.tangentialDecay = 2.0;
  const Collider plane(table, 0.0);
  Contacts contacts = contactsWith(plane);
  Particle particle;
  particle.v = Vec3(1.0, -0.5, 0.0);
  const double h = 1.0 / 600.0;
  for (int k = 0; k < 600; ++k) substep(particle, contacts, h);
  EXPECT_NEAR(particle.v.x(), std::exp(-2.0), 1e-10);
  EXPECT_NEAR(particle.v.y(), -0.5 * std::exp(-2.0), 1e-10);
}

TEST(ContactFriction, AMovingTableTakesTheParticleAlong) {
  Obstacle table;
  table.shape = BoxShape{Vec3(4.0, 4.0, 0.1)};
  table.pose.position = Vec3(0.0, 0.0, -0.05);
  table.velocity = Vec3(0.5, 0.0, 0.0);
  table.friction = 0.3;
  const Collider collider(table, 0.0);
  Contacts contacts = contactsWith(collider);
  Particle particle;
  const double h = 1.0 / 600.0;
  for (int k = 0; k < 600; ++k) substep(particle, contacts, h);
  EXPECT_NEAR(particle.v.x(), 0.5, 1e-10);
  // The particle lags by what it slid until it was as fast, v^2 / (2 mu g), to the first order in
  // h.
  EXPECT_NEAR(particle.x.x(), 0.5 - 0.25 / (2.0 * 0.3 * kGravity), 0.5 * h);
}

/// On top of a level rod the law is that of a plane: below atan(mu) to the rod's tangent it sticks.
TEST(ContactFriction, HoldsOnARodUpToTheAngleOfFriction) {
  const double mu = 0.3;
  for (const double tilt : {0.0, 0.9, 1.1}) {
    Obstacle rod;
    rod.shape = CapsuleShape{0.1, 1.0};
    rod.pose.orientation = Quat::FromTwoVectors(Vec3::UnitZ(), Vec3::UnitX());
    rod.friction = mu;
    const Collider collider(rod, 0.0);
    Contacts contacts = contactsWith(collider);
    const double angle = tilt * std::atan(mu);
    Particle particle;
    particle.x = 0.1 * Vec3(0.0, std::sin(angle), std::cos(angle)) + Vec3(0.2, 0.0, 0.0);
    const Vec3 start = particle.x;
    for (int k = 0; k < 300; ++k) substep(particle, contacts, 1.0 / 600.0);
    EXPECT_EQ(tilt < 1.0, (particle.x - start).norm() < 1e-9) << tilt;
    EXPECT_GE(collider.gap(particle.x, 0.0), -1e-9);
  }
}

TEST(ContactMoving, ASpherePushesAParticleInFrontOfIt) {
  Obstacle sphere;
  sphere.shape = SphereShape{0.1};
  sphere.pose.position = Vec3(-0.2, 0.0, 0.0);
  sphere.velocity = Vec3(1.0, 0.0, 0.0);
  sphere.friction = 0.0;
  const Collider collider(sphere, 0.0);
  Contacts contacts = contactsWith(collider);
  Particle particle;
  const double h = 1.0 / 600.0;
  for (int k = 0; k < 300; ++k) substep(particle, contacts, h, Vec3::Zero());
  EXPECT_NEAR(particle.x.x(), 0.4, 1e-9);  // -0.2 + 0.5 + radius
  EXPECT_NEAR(particle.v.x(), 1.0, 1e-9);
}

// ---- overlap, impulse, prescribed particles -----------------------------------------------------

TEST(ContactOverlap, AParticleInsideLeavesAtABoundedSpeed) {
  Obstacle sphere;
  sphere.shape = SphereShape{0.1};
  for (const Vec3& place : {Vec3(0.01, 0.02, 0.03), Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, -0.05)}) {
    const Collider collider(sphere, 0.0);
    Contacts contacts = contactsWith(collider);
    Particle particle;
    particle.x = place;
    const double h = 1.0 / 600.0;
    double gap = collider.gap(place, 0.0);
    for (int k = 0; k < 90; ++k) {
      substep(particle, contacts, h, Vec3::Zero());
      EXPECT_LE(particle.v.norm(), kDepenetrationSpeed * (1.0 + 1e-12));
      EXPECT_GE(collider.gap(particle.x, 0.0), gap - 1e-12);  // never deeper
      gap = collider.gap(particle.x, 0.0);
    }
    EXPECT_GE(gap, 0.0);  // 0.1 m at 1 m/s take 60 substeps
  }
}

TEST(ContactOverlap, OneThatDivesIsHeldAtItsDepth) {
  const Collider plane = incline(0.0, 0.3);
  Contacts contacts = contactsWith(plane);
  const double h = 1.0 / 600.0;
  const Vec3 start(0.0, 0.0, -0.05);
  const Vec3 end = projected(contacts, start, start - Vec3(0.0, 0.0, 0.5), 0.01, h, h);
  EXPECT_NEAR(end.z(), start.z() + kDepenetrationSpeed * h, 1e-12);
}

TEST(ContactOverlap, OneThatLeavesBySelfIsLeftAlone) {
  Obstacle sphere;
  sphere.shape = SphereShape{0.1};
  const Collider collider(sphere, 0.0);
  Contacts contacts = contactsWith(collider);
  const Vec3 end(0.0, 0.0, 0.12);
  EXPECT_EQ(projected(contacts, Vec3(0.0, 0.0, 0.05), end, 0.01, 0.01, 0.01), end);
  EXPECT_EQ(contacts.candidates[0].impulse.linear, Vec3::Zero());
}

TEST(ContactImpulse, OfAParticleAtRestIsItsWeight) {
  for (const double angle : {0.0, 0.25}) {
    const Collider plane = incline(angle, 0.3);
    Contacts contacts = contactsWith(plane);
    Particle particle;
    particle.x = 0.001 * plane.normal(Vec3::Zero(), 0.0);
    const double h = 1.0 / 600.0;
    substep(particle, contacts, h);
    contacts.candidates[0].impulse.linear.setZero();
    for (int k = 0; k < 600; ++k) substep(particle, contacts, h);
    const Vec3 weight(0.0, 0.0, -particle.mass * kGravity);
    EXPECT_LT((contacts.candidates[0].impulse.linear - weight * 1.0).norm(), 1e-12);
  }
}

TEST(ContactImpulse, OfAnImpactIsTheMomentumLost) {
  const Collider plane = incline(0.2, 0.3);
  Contacts contacts = contactsWith(plane);
  Particle particle;
  particle.x = plane.normal(Vec3::Zero(), 0.0);
  particle.v = Vec3(1.0, 2.0, -5.0);
  const Vec3 before = particle.mass * particle.v;
  for (int k = 0; k < 600; ++k) substep(particle, contacts, 1.0 / 600.0, Vec3::Zero());
  EXPECT_LT((contacts.candidates[0].impulse.linear + particle.mass * particle.v - before).norm(),
            1e-12);
  EXPECT_GT(contacts.candidates[0].impulse.linear.norm(), 0.01);
}

TEST(ContactPrescribed, IsPushedOutFullyWithoutFrictionOrImpulse) {
  Obstacle sphere;
  sphere.shape = SphereShape{0.1};
  sphere.friction = 10.0;
  const Collider collider(sphere, 0.0);
  Contacts contacts = contactsWith(collider);
  const double h = 0.01;
  // From inside, at once.
  Vec3 end = projected(contacts, Vec3(0.0, 0.0, 0.05), Vec3(0.02, 0.0, 0.05), 0.0, h, h);
  EXPECT_LT((end - Vec3(0.02, 0.0, 0.1)).norm(), 1e-12);  // slid freely along the surface
  // From outside, at the surface.
  end = projected(contacts, Vec3(0.0, 0.0, 0.2), Vec3(0.0, 0.0, -0.5), 0.0, h, h);
  EXPECT_LT((end - Vec3(0.0, 0.0, 0.1)).norm(), 1e-12);
  EXPECT_EQ(contacts.candidates[0].impulse.linear, Vec3::Zero());
}

TEST(ContactView, FindsParticlesThroughTheirSlots) {
  const Collider plane = incline(0.0, 0.0);
  Contacts contacts;
  contacts.add(&plane).vertices = {0, 2};
  std::vector<double> x(3, 0.0), y(3, 0.0), z{-1.0, -1.0, 0.5};  // of the vertices 2, 1, 0
  const std::vector<double> startZ(3, 0.5), mass(3, 1.0);
  const std::vector<std::int32_t> slots{2, 1, 0};
  ParticleView view{x.data(), y.data(),      z.data(),    x.data(),
                    y.data(), startZ.data(), mass.data(), slots.data()};
  contacts.project(view, 0.01, 0.01);
  EXPECT_NEAR(z[0], 0.001, 1e-15);
  EXPECT_EQ(z[1], -1.0);  // no candidate
  EXPECT_EQ(z[2], 0.5);
}

/// Particles, and what they gave an incline, after a substep on so many threads.
std::pair<std::vector<double>, Vec3> projectedOn(int threads) {
  const Collider plane = incline(0.3, 0.5);
  constexpr std::size_t kParticles = 20'000;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> place(-0.1, 0.1);
  std::vector<double> x, start, mass(kParticles, 0.01);
  for (std::size_t k = 0; k < 3 * kParticles; ++k) {
    start.push_back(place(random));
    x.push_back(start.back() + 0.1 * place(random));
  }
  Contacts contacts;
  contacts.add(&plane).vertices.resize(kParticles);
  std::iota(contacts.candidates[0].vertices.begin(), contacts.candidates[0].vertices.end(), 0);
  ParticleView view{&x[0],
                    &x[kParticles],
                    &x[2 * kParticles],
                    &start[0],
                    &start[kParticles],
                    &start[2 * kParticles],
                    &mass[0],
                    nullptr};
  const ThreadLimit limit(threads);
  ThreadPool pool;
  const ThreadPool::ParallelRegion region(pool);
  for (int again = 0; again < 5; ++again) contacts.project(view, 0.01, 0.01);
  return {x, contacts.candidates[0].impulse.linear};
}

TEST(ContactView, IsTheSameOnAnyNumberOfThreads) {
  const auto [x, impulse] = projectedOn(1);
  EXPECT_GT(impulse.norm(), 1.0);
  for (const int threads : {2, 3}) {
    const auto [found, given] = projectedOn(threads);
    EXPECT_EQ(found, x) << threads;
    EXPECT_EQ(given, impulse) << threads;
  }
}

}  // namespace
}  // namespace cloth_sim
