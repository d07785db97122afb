/// \file Corrections along springs, four at a time, are those of one spring after the other.

#include "constraints/spring_projection.h"

#include <gtest/gtest.h>

#include <set>

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

/// As Compliance says, one spring after the other.
void correctOneByOne(const SpringSchedule& schedule, Particles& p) {
  schedule.sweep([&](const SpringSchedule::Element& spring) {
    const auto [alpha, lag] = complianceOf(spring.parameters, kStep);
    const Vec3 d = p.x.at(spring.b) - p.x.at(spring.a);
    const Vec3 start = p.start.at(spring.b) - p.start.at(spring.a);
    const double wa = p.inverseMass[spring.a];
    const double wb = p.inverseMass[spring.b];
    const double squared = d.x() * d.x() + d.y() * d.y() + d.z() * d.z() + kTinySquare;
    const double length = std::sqrt(squared);
    double f = (length - spring.parameters.restLength) / (length * (wa + wb + alpha));
    if (schedule.parameters.damped()) {
      const double moved =
          (squared - d.x() * start.x() - d.y() * start.y() - d.z() * start.z()) / length;
      f = (length - spring.parameters.restLength + lag * moved) /
          (length * ((1.0 + lag) * (wa + wb) + alpha));
    }
    p.x.set(spring.a, p.x.at(spring.a) + f * wa * d);
    p.x.set(spring.b, p.x.at(spring.b) - f * wb * d);
  });
}

void expectIsOneByOne(Scheduled& cloth) {
  Particles expected = cloth.particles;
  correctOneByOne(cloth.schedule, expected);
  SpringProjection correction;
  correction.setMasses(cloth.schedule, cloth.particles.inverseMass);
  correction.setStep(cloth.schedule, kStep);
  correction.correct(cloth.schedule, cloth.particles);
  EXPECT_EQ(cloth.particles.x.x, expected.x.x);
  EXPECT_EQ(cloth.particles.x.y, expected.x.y);
  EXPECT_EQ(cloth.particles.x.z, expected.x.z);
}

/// How many have springs that edits made.
std::size_t overflowParticles(const SpringSchedule& schedule) {
  std::set<std::int32_t> slots;
  for (std::size_t s = schedule.firstOverflow(); s < schedule.spans().size(); ++s) {
    schedule.visit(schedule.spans()[s], [&](const SpringSchedule::Element& spring) {
      slots.insert({spring.a, spring.b});
    });
  }
  return slots.size();
}

TEST(SpringProjection, IsThatOfOneSpringAfterTheOtherAlsoAfterCutsAndRefinements) {
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
        cloth.follow(cloth.edit(random));
        later = std::max(later, overflowParticles(cloth.schedule));
      }
      shake(random, cloth);
      expectIsOneByOne(cloth);
    }
  }
  EXPECT_GT(later, 100U);
}

/// Springs of a run, [from, end), by hand.
bool isEven(const SpringSchedule::Span& run, const ScalarArray& w, std::int32_t from,
            std::int32_t end) {
  for (std::int32_t k = from; k < end; ++k) {
    if (w[run.ends.a + k] != w[run.ends.a + from]) return false;
    if (w[run.ends.b + k] != w[run.ends.a + from]) return false;
  }
  return true;
}

TEST(EvenStretches, AreTheLongestOfTheirRunsInWholeFours) {
  Generator random(5);
  std::vector<UniformMassRange> stretches;
  std::int32_t springs = 0;
  for (const auto& [columns, rows] : {std::pair(5, 4), std::pair(31, 9), std::pair(80, 6)}) {
    Scheduled cloth(clothOf(columns, rows, 0.05));
    for (int trial = 0; trial < 20; ++trial) {
      shake(random, cloth);
      const ScalarArray& w = cloth.particles.inverseMass;
      findUniformMassRanges(cloth.schedule, w, stretches);
      ASSERT_EQ(stretches.size(), cloth.schedule.spans().size());
      for (std::size_t s = 0; s < stretches.size(); ++s) {
        const SpringSchedule::Span& span = cloth.schedule.spans()[s];
        const auto [from, end] = stretches[s];
        std::int32_t longest = 0;
        for (std::int32_t k = 0; span.isContiguous && k < span.count; k += 4) {
          for (std::int32_t e = k + 4; e <= span.count && isEven(span, w, k, e); e += 4) {
            longest = std::max(longest, e - k);
          }
        }
        EXPECT_EQ(end - from, longest);
        EXPECT_TRUE(longest == 0 || isEven(span, w, from, end));
        EXPECT_EQ(from % 4, 0);
        springs += longest;
      }
    }
  }
  EXPECT_GT(springs, 1000);
}

}  // namespace
}  // namespace cloth_sim
