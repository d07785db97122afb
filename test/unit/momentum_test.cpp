/// \file Momentum of sets of particles, and its restoration.

#include "surgery/momentum.h"

#include <gtest/gtest.h>

#include <numeric>

#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

struct Particles {
  VertexData<double> mass;
  State state;
  std::vector<VertexId> all;

  Particles(int count, Generator& random)
      : mass(static_cast<std::size_t>(count), 0.0), all(static_cast<std::size_t>(count)) {
    state.x = VertexData<Vec3>(all.size(), Vec3::Zero());
    state.v = VertexData<Vec3>(all.size(), Vec3::Zero());
    std::iota(all.begin(), all.end(), 0);
    for (VertexId v : all) {
      mass[v] = uniform(random, 0.1, 10.0);
      state.x[v] = randomVector(random, 2.0);
      state.v[v] = randomVector(random, 3.0);
    }
  }

  void shakeVelocities(Generator& random) {
    for (Vec3& v : state.v) v += randomVector(random, 0.5);
  }
};

/// Sums of the magnitudes of all terms, to which rounding errors are relative.
struct Scale {
  double linear = 0.0;
  double angular = 0.0;
};

Scale scaleOf(const Particles& p) {
  Scale scale;
  for (VertexId v : p.all) {
    scale.linear += p.mass[v] * p.state.v[v].norm();
    scale.angular += p.mass[v] * p.state.v[v].norm() * p.state.x[v].norm();
  }
  return scale;
}

void expectMomentum(const Particles& p, const Momentum& wanted) {
  const Momentum now = momentumOf(p.all, p.mass, p.state);
  const Scale scale = scaleOf(p);
  EXPECT_LE((now.linear - wanted.linear).norm(), 1e-14 * scale.linear);
  EXPECT_LE((now.angular - wanted.angular).norm(), 1e-14 * scale.angular);
}

TEST(MomentumOf, SumsUp) {
  Generator random(1);
  Particles p(3, random);
  for (VertexId v : p.all) {
    p.mass[v] = 1.0 + v;
    p.state.x[v] = Vec3(1.0 * v, 0.0, 0.0);
    p.state.v[v] = Vec3(0.0, 2.0, 0.0);
  }
  const Momentum all = momentumOf(p.all, p.mass, p.state);
  EXPECT_EQ(all.linear, Vec3(0.0, 2.0 * (1 + 2 + 3), 0.0));
  EXPECT_EQ(all.angular, Vec3(0.0, 0.0, 2.0 * (0 * 1 + 1 * 2 + 2 * 3)));
  const Momentum one = momentumOf({2}, p.mass, p.state);
  EXPECT_EQ(one.linear, Vec3(0.0, 6.0, 0.0));
}

TEST(MomentumOf, LeavesOutWhatTheMassesDoNotKnow) {
  Generator random(2);
  Particles p(4, random);
  const Momentum known = momentumOf(p.all, p.mass, p.state);
  const Momentum more = momentumOf({0, 1, 2, 3, 4, 5}, p.mass, p.state);
  EXPECT_EQ(more.linear, known.linear);
  EXPECT_EQ(more.angular, known.angular);
}

/// Checks that the momentum of all particles is restored after their velocities have changed.
void expectRestored(Particles& p, Generator& random) {
  const Momentum wanted = momentumOf(p.all, p.mass, p.state);
  p.shakeVelocities(random);
  restoreMomentum(wanted, p.all, p.mass, p.state);
  expectMomentum(p, wanted);
}

TEST(RestoreMomentum, OfRandomParticlesToRounding) {
  Generator random(3);
  for (int trial = 0; trial < 200; ++trial) {
    Particles p(whole(random, 3, 30), random);
    expectRestored(p, random);
  }
}

TEST(RestoreMomentum, OfFlatOnesFarFromTheOrigin) {
  // Points like those of the faces around an edit: a few centimetres across, metres away.
  Generator random(4);
  for (int trial = 0; trial < 200; ++trial) {
    Particles p(whole(random, 4, 12), random);
    const Vec3 away = randomVector(random, 2.0);
    for (Vec3& x : p.state.x) x = away + Vec3(0.02 * x.x(), 0.02 * x.y(), 0.0);
    expectRestored(p, random);
  }
}

TEST(RestoreMomentum, AddsARigidMotionAndNothingElse) {
  Generator random(5);
  Particles p(8, random);
  Momentum wanted = momentumOf(p.all, p.mass, p.state);
  wanted.linear += Vec3(1.0, -2.0, 0.5);
  wanted.angular += Vec3(0.3, 0.2, -1.0);
  const State before = p.state;
  restoreMomentum(wanted, p.all, p.mass, p.state);
  expectMomentum(p, wanted);
  for (VertexId a : p.all) {
    EXPECT_EQ(p.state.x[a], before.x[a]);
    for (VertexId b : p.all) {
      // Distances do not change at a rigid motion.
      const Vec3 d = p.state.x[a] - p.state.x[b];
      const Vec3 rate = (p.state.v[a] - before.v[a]) - (p.state.v[b] - before.v[b]);
      EXPECT_NEAR(d.dot(rate), 0.0, 1e-13);
    }
  }
}

TEST(RestoreMomentum, OnlyTouchesTheGivenParticles) {
  Generator random(6);
  Particles p(10, random);
  const State before = p.state;
  restoreMomentum(Momentum{}, {1, 4, 5, 7}, p.mass, p.state);
  for (VertexId v : {0, 2, 3, 6, 8, 9}) EXPECT_EQ(p.state.v[v], before.v[v]);
  restoreMomentum(Momentum{}, {}, p.mass, p.state);
}

TEST(RestoreMomentum, OfParticlesInALine) {
  // There is nothing to turn about the line, and no momentum about it to restore either.
  Generator random(7);
  for (int trial = 0; trial < 200; ++trial) {
    Particles p(whole(random, 2, 8), random);
    const Vec3 origin = randomVector(random, 1.0);
    const Vec3 along = randomVector(random, 1.0).normalized();
    for (Vec3& x : p.state.x) x = origin + x.x() * along;
    const Momentum wanted = momentumOf(p.all, p.mass, p.state);
    p.shakeVelocities(random);
    restoreMomentum(wanted, p.all, p.mass, p.state);
    EXPECT_TRUE(isFinite(p.state));
    expectMomentum(p, wanted);
  }
}

TEST(RestoreMomentum, OfASingleParticle) {
  Generator random(8);
  for (int trial = 0; trial < 200; ++trial) {
    Particles p(1, random);
    const Vec3 velocity = p.state.v[0];
    const Momentum wanted = momentumOf(p.all, p.mass, p.state);
    p.shakeVelocities(random);
    restoreMomentum(wanted, p.all, p.mass, p.state);
    ASSERT_TRUE(isFinite(p.state));
    EXPECT_LE((p.state.v[0] - velocity).norm(), 1e-14 * (1.0 + velocity.norm())) << trial;
  }
}

TEST(RestoreMomentum, OfParticlesAtOnePlace) {
  // A vertex and its copies, say. What cannot be restored is left.
  Generator random(9);
  for (int trial = 0; trial < 200; ++trial) {
    Particles p(3, random);
    for (Vec3& x : p.state.x) x = Vec3(p.state.x[0]);
    const Momentum wanted = momentumOf(p.all, p.mass, p.state);
    p.shakeVelocities(random);
    restoreMomentum(wanted, p.all, p.mass, p.state);
    ASSERT_TRUE(isFinite(p.state));
    expectMomentum(p, wanted);
    for (const Vec3& v : p.state.v) EXPECT_LT(v.norm(), 20.0) << trial;
  }
}

}  // namespace
}  // namespace cloth_sim
