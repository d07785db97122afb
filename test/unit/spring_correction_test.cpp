/// \file Corrections along springs, four at a time, are those of one spring after the other.

#include "../../src/solver/spring_correction.h"

#include <gtest/gtest.h>

#include "unit/scheduled.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kStep = 1.0 / 1200.0;  // [s]

/// Anywhere near where they hang, and moving.
void shake(Generator& random, Scheduled& cloth) {
  cloth.particles.load(cloth.state);
  cloth.particles.loadMasses(cloth.model, {});
  for (std::size_t k = 0; k < cloth.particles.mass.size(); ++k) {
    const Vec3 at = cloth.particles.x.at(k) + randomVector(random, 0.01);
    cloth.particles.x.set(k, at);
    cloth.particles.start.set(k, at - randomVector(random, 0.001));
  }
}

/// As Compliances says, one spring after the other.
void correctOneByOne(const SpringSchedule& schedule, PackedParticles& p) {
  schedule.sweep([&](const SpringSchedule::Element& spring) {
    const auto [alpha, lag] = complianceOf(spring.law, kStep);
    const Vec3 d = p.x.at(spring.b) - p.x.at(spring.a);
    const Vec3 start = p.start.at(spring.b) - p.start.at(spring.a);
    const double wa = p.inverseMass[spring.a];
    const double wb = p.inverseMass[spring.b];
    const double squared = d.x() * d.x() + d.y() * d.y() + d.z() * d.z() + kTinySquare;
    const double length = std::sqrt(squared);
    double f = (length - spring.law.restLength) / (length * (wa + wb + alpha));
    if (schedule.laws.damped()) {
      const double moved =
          (squared - d.x() * start.x() - d.y() * start.y() - d.z() * start.z()) / length;
      f = (length - spring.law.restLength + lag * moved) /
          (length * ((1.0 + lag) * (wa + wb) + alpha));
    }
    p.x.set(spring.a, p.x.at(spring.a) + f * wa * d);
    p.x.set(spring.b, p.x.at(spring.b) - f * wb * d);
  });
}

void expectIsOneByOne(Generator& random, Scheduled& cloth) {
  shake(random, cloth);
  PackedParticles expected = cloth.particles;
  correctOneByOne(cloth.schedule, expected);
  Compliances compliances;
  setCompliances(cloth.schedule.laws, kStep, compliances);
  correctSprings(cloth.schedule, compliances, cloth.particles);
  EXPECT_EQ(cloth.particles.x.x, expected.x.x);
  EXPECT_EQ(cloth.particles.x.y, expected.x.y);
  EXPECT_EQ(cloth.particles.x.z, expected.x.z);
}

TEST(SpringCorrection, IsThatOfOneSpringAfterTheOtherAlsoAfterCutsAndRefinements) {
  Generator random(23);
  std::size_t later = 0;
  for (const double damping : {0.0, 1e-4}) {
    Fabric fabric = fabricPreset("silk");
    fabric.damping = damping;
    for (const auto& [columns, rows] : {std::pair(2, 2), std::pair(9, 6), std::pair(31, 40)}) {
      Scheduled cloth(clothOf(columns, rows, 0.05, fabric));
      EXPECT_EQ(cloth.schedule.laws.damped(), damping > 0.0);
      for (int edit = 0; edit < 6; ++edit) {
        expectIsOneByOne(random, cloth);
        cloth.follow(cloth.edit(random));
        later = std::max(later, cloth.schedule.laterSlots().size());
      }
      expectIsOneByOne(random, cloth);
    }
  }
  EXPECT_GT(later, 100U);
}

}  // namespace
}  // namespace cloth_sim
