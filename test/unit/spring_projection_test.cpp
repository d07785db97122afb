/// \file The projection of springs four at a time is the scalar reference, bit by bit.

#include "constraints/spring_projection.h"  // private: the kernel is compared with its reference

#include <gtest/gtest.h>

#include <set>

#include "constraints/reference_projection.h"
#include "unit/scheduled.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kStep = 1.0 / 1200.0;  // [s]

/// Anywhere near where they hang, and moving; some are held.
void shake(Generator& random, Scheduled& cloth) {
  std::vector<KinematicTarget> held;
  for (VertexId v = 0; v < cloth.model.particleCount(); ++v) {
    if (random() % 100 == 0) held.push_back({v, Vec3::Zero(), Vec3::Zero()});
  }
  cloth.particles.load(cloth.state);
  cloth.particles.loadMasses(cloth.model, held);
  for (std::size_t k = 0; k < cloth.particles.mass.size(); ++k) {
    const Vec3 at = cloth.particles.x.at(k) + randomVector(random, 0.01);
    cloth.particles.x.set(k, at);
    cloth.particles.start.set(k, at - randomVector(random, 0.001));
  }
}

/// Projects one spring after the other by the scalar reference.
template <bool kDamped>
void projectOneByOne(const SpringSchedule& schedule, Particles& p) {
  schedule.sweep([&](const SpringSchedule::Element& spring) {
    const auto a = static_cast<std::size_t>(spring.a);
    const auto b = static_cast<std::size_t>(spring.b);
    projectSpring<kDamped>(
        a, b, spring.parameters.restLength,
        projectionWeights(spring.parameters, p.inverseMass[a], p.inverseMass[b], kStep), p);
  });
}

void expectIsOneByOne(Scheduled& cloth) {
  Particles expected = cloth.particles;
  cloth.schedule.parameters.damped() ? projectOneByOne<true>(cloth.schedule, expected)
                                     : projectOneByOne<false>(cloth.schedule, expected);
  SpringProjection projection;
  projection.setMasses(cloth.schedule, cloth.particles.inverseMass);
  projection.setStep(cloth.schedule, cloth.particles.inverseMass, kStep);
  projection.project(cloth.schedule, cloth.particles);
  EXPECT_EQ(cloth.particles.x.x, expected.x.x);
  EXPECT_EQ(cloth.particles.x.y, expected.x.y);
  EXPECT_EQ(cloth.particles.x.z, expected.x.z);
}

/// Number of particles that have springs in the overflow.
std::size_t overflowParticles(const SpringSchedule& schedule) {
  std::set<std::int32_t> slots;
  for (std::size_t s = schedule.firstOverflow(); s < schedule.spans().size(); ++s) {
    schedule.visit(schedule.spans()[s], [&](const SpringSchedule::Element& spring) {
      slots.insert({spring.a, spring.b});
    });
  }
  return slots.size();
}

TEST(SpringProjection, IsTheReferenceBitByBitAlsoAfterCutsAndRefinements) {
  Generator random(23);
  std::size_t later = 0;
  for (const double damping : {0.0, 1e-4}) {
    Fabric fabric = fabricPreset("silk");
    fabric.damping = damping;
    for (const auto& [columns, rows] : {std::pair(2, 2), std::pair(9, 6), std::pair(31, 40)}) {
      Scheduled cloth(clothOf(columns, rows, 0.05, fabric));
      EXPECT_EQ(cloth.schedule.parameters.damped(), damping > 0.0);
      for (int edit = 0; edit < 6; ++edit) {
        shake(random, cloth);
        expectIsOneByOne(cloth);
        cloth.applyChanges(cloth.edit(random));
        later = std::max(later, overflowParticles(cloth.schedule));
      }
      shake(random, cloth);
      expectIsOneByOne(cloth);
    }
  }
  EXPECT_GT(later, 100U);
}

/// A published step of the textbook: two particles, one spring, by hand.
TEST(SpringProjection, ReferenceIsEquation18Of2016) {
  Particles p;
  p.slots = 2;
  p.resize();
  p.x.set(0, Vec3(0.0, 0.0, 0.0));
  p.x.set(1, Vec3(0.0, 3.0, 4.0));
  const SpringParameters spring{4.0, 100.0, 0.0};
  const double wa = 2.0;
  const double wb = 6.0;
  const double alpha = 1.0 / (100.0 * kStep * kStep);
  const double lambda = (5.0 - 4.0) / (wa + wb + alpha);
  projectSpring<false>(0, 1, spring.restLength, projectionWeights(spring, wa, wb, kStep), p);
  EXPECT_LT((p.x.at(0) - wa * lambda * Vec3(0.0, 0.6, 0.8)).norm(), 1e-15);
  EXPECT_LT((p.x.at(1) - (Vec3(0.0, 3.0, 4.0) - wb * lambda * Vec3(0.0, 0.6, 0.8))).norm(), 2e-15);
}

TEST(SpringProjection, DashpotsAddTheirRatioAsInEquation26Of2016) {
  const SpringParameters spring{4.0, 100.0, 0.3};
  const double alpha = 1.0 / (100.0 * kStep * kStep);
  const double gamma = 0.3 / (100.0 * kStep);
  const ProjectionWeights weights = projectionWeights(spring, 2.0, 6.0, kStep);
  EXPECT_DOUBLE_EQ(weights.gamma, gamma);
  EXPECT_DOUBLE_EQ(weights.a, 2.0 / ((1.0 + gamma) * 8.0 + alpha));
  EXPECT_DOUBLE_EQ(weights.b, 6.0 / ((1.0 + gamma) * 8.0 + alpha));
}

TEST(SpringProjection, ASpringThatIsGoneHasNoWeight) {
  const ProjectionWeights weights = projectionWeights({}, 2.0, 6.0, kStep);
  EXPECT_EQ(weights.a, 0.0);
  EXPECT_EQ(weights.b, 0.0);
}

}  // namespace
}  // namespace cloth_sim
