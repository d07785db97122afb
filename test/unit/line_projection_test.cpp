/// \file Lines of springs hold every spring once, and their direct solves are those of a dense
/// system.

#include "constraints/line_projection.h"  // private: the kernel is compared with a dense solve

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <set>

#include "unit/scheduled.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kStep = 1.0 / 1200.0;  // [s]

/// The springs of one lane of a block, in their order, with the slots of their particles.
struct LineOfBlock {
  std::vector<std::int32_t> springs, slots;
};

std::vector<LineOfBlock> linesOf(const SpringLines& lines, const SpringLines::SimdBlock& block) {
  std::vector<LineOfBlock> result;
  for (std::size_t lane = 0; lane < SpringLines::kWidth; ++lane) {
    LineOfBlock line;
    for (std::int32_t s = 0; s < block.steps; ++s) {
      const std::int32_t spring = lines.springs()[block.firstStep + s][lane];
      if (spring == kNone) break;
      if (s == 0) line.slots.push_back(lines.slots()[block.firstPlace][lane]);
      line.springs.push_back(spring);
      line.slots.push_back(lines.slots()[block.firstPlace + s + 1][lane]);
    }
    if (!line.springs.empty()) result.push_back(line);
  }
  return result;
}

template <typename Visit>
void forColours(const SpringLines& lines, const Visit& visit) {
  for (const SpringLines::Colour& colour : lines.colours()) {
    std::vector<LineOfBlock> all;
    for (std::int32_t b = colour.firstBlock; b < colour.endBlock; ++b) {
      for (const LineOfBlock& line : linesOf(lines, lines.blocks()[b])) all.push_back(line);
    }
    visit(colour, all);
  }
}

/// Checks that lines hold every spring once, join its ends, and share no particle within a colour.
void expectHoldsEverySpringOnce(const Scheduled& cloth, const SpringLines& lines) {
  std::multiset<std::int32_t> seen;
  forColours(lines, [&](const SpringLines::Colour&, const std::vector<LineOfBlock>& all) {
    std::set<std::int32_t> particles;
    std::size_t places = 0;
    for (const LineOfBlock& line : all) {
      for (std::size_t s = 0; s < line.springs.size(); ++s) {
        const Spring spring = cloth.model.springs[line.springs[s]];
        const std::set<std::int32_t> ends{cloth.particles.slotOf[spring.a],
                                          cloth.particles.slotOf[spring.b]};
        ASSERT_EQ(ends, (std::set<std::int32_t>{line.slots[s], line.slots[s + 1]}));
        seen.insert(line.springs[s]);
      }
      places += line.slots.size();
      particles.insert(line.slots.begin(), line.slots.end());
    }
    EXPECT_EQ(particles.size(), places) << "lines of a colour share a particle";
  });
  EXPECT_EQ(static_cast<std::int32_t>(seen.size()), cloth.model.springs.count());
  EXPECT_EQ((std::set<std::int32_t>(seen.begin(), seen.end()).size()), seen.size());
}

TEST(SpringLines, OfAGridAreItsRowsColumnsAndDiagonals) {
  const Scheduled cloth(clothOf(9, 7, 0.05, fabricPreset("cotton")));
  SpringLines lines;
  lines.build(cloth.model, cloth.particles.slotOf);
  expectHoldsEverySpringOnce(cloth, lines);
  ASSERT_EQ(lines.colours().size(), 6U);  // two directions for each of three kinds
  std::vector<std::set<std::size_t>> lengths;
  forColours(lines, [&](const SpringLines::Colour&, const std::vector<LineOfBlock>& all) {
    std::set<std::size_t> of;
    for (const LineOfBlock& line : all) of.insert(line.springs.size());
    lengths.push_back(of);
  });
  // Structural springs come last: nine columns of six springs, seven rows of eight.
  EXPECT_EQ((std::set<std::set<std::size_t>>{lengths[4], lengths[5]}),
            (std::set<std::set<std::size_t>>{{6}, {8}}));
  EXPECT_EQ(*lengths[2].rbegin(), 6U);  // the longest diagonals
}

TEST(SpringLines, HoldEverySpringOnceAfterCutsAndRefinement) {
  Generator random(5);
  Scheduled cloth(clothOf(14, 11, 0.05, fabricPreset("cotton")));
  for (int edit = 0; edit < 12; ++edit) {
    cloth.edit(random);
    SpringLines lines;
    lines.build(cloth.model, cloth.particles.slotOf);
    expectHoldsEverySpringOnce(cloth, lines);
  }
}

/// Solves the system of line_projection.h for one line, and moves its particles.
void projectDensely(const Scheduled& cloth, const LineOfBlock& line, const ScalarArray& w,
                    Particles& p) {
  const auto n = static_cast<Eigen::Index>(line.springs.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd rightSide(n);
  std::vector<Vec3> direction;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto a = static_cast<std::size_t>(line.slots[k]);
    const auto b = static_cast<std::size_t>(line.slots[k + 1]);
    const Spring spring = cloth.model.springs[line.springs[k]];
    const Vec3 d = p.x.at(b) - p.x.at(a);
    const Vec3 start = p.start.at(b) - p.start.at(a);
    const double gamma = spring.damping / (spring.stiffness * kStep);
    direction.push_back(d.normalized());
    matrix(i, i) = w[a] + w[b] + 1.0 / (spring.stiffness * kStep * kStep * (1.0 + gamma));
    if (i > 0) {
      matrix(i, i - 1) = matrix(i - 1, i) = -w[a] * direction[k].dot(direction[k - 1]);
    }
    rightSide(i) =
        (d.norm() - spring.restLength + gamma * direction[k].dot(d - start)) / (1.0 + gamma);
  }
  const Eigen::VectorXd mu = matrix.ldlt().solve(rightSide);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto a = static_cast<std::size_t>(line.slots[k]);
    const auto b = static_cast<std::size_t>(line.slots[k + 1]);
    p.x.set(a, p.x.at(a) + w[a] * mu(i) * direction[k]);
    p.x.set(b, p.x.at(b) - w[b] * mu(i) * direction[k]);
  }
}

/// Displaces particles at random; every hundredth is held.
void disturb(Generator& random, Scheduled& cloth) {
  std::vector<KinematicTarget> held;
  for (VertexId v = 0; v < cloth.model.particleCount(); ++v) {
    if (v == 3 || random() % 40 == 0) held.push_back({v, Vec3::Zero(), Vec3::Zero()});
  }
  cloth.particles.load(cloth.state);
  cloth.particles.loadMasses(cloth.model, held);
  for (std::size_t k = 0; k < cloth.particles.mass.size(); ++k) {
    const Vec3 at = cloth.particles.x.at(k) + randomVector(random, 0.003);
    cloth.particles.x.set(k, at);
    cloth.particles.start.set(k, at - randomVector(random, 0.001));
  }
}

void expectIsTheDenseSolve(Generator& random, Scheduled& cloth) {
  disturb(random, cloth);
  SpringLines lines;
  lines.build(cloth.model, cloth.particles.slotOf);
  Particles expected = cloth.particles;
  const ScalarArray& w = cloth.particles.inverseMass;
  LineProjection projection;
  projection.prepare(lines, cloth.model.springs);
  projection.setStep(kStep);
  forColours(lines, [&](const SpringLines::Colour&, const std::vector<LineOfBlock>& all) {
    for (const LineOfBlock& line : all) projectDensely(cloth, line, w, expected);
  });
  const std::size_t n = cloth.particles.mass.size();
  VectorArray pull;
  pull.resize(n);
  ScalarArray cancelled(n, -1.0);
  const Particles before = cloth.particles;
  projection.projectAndMeasure(lines, w, cloth.particles, pull, cancelled);
  Vec3 momentum = Vec3::Zero(), onHolders = Vec3::Zero();
  double largest = 0.0, error = 0.0, impulses = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 by = cloth.particles.x.at(k) - before.x.at(k);
    momentum += cloth.particles.mass[k] * by;
    onHolders += pull.at(k);
    largest = std::max(largest, by.norm());
    error = std::max(error, (cloth.particles.x.at(k) - expected.x.at(k)).norm());
    EXPECT_GE(cancelled[k], -1e-6 * by.norm() - 1e-15);
    impulses += cloth.particles.mass[k] * by.norm();
  }
  // Well-conditioned systems of at most a dozen unknowns, in single precision.
  EXPECT_LT(error, 5e-6 * largest);
  EXPECT_GT(largest, 1e-4);
  // The momentum of particles and holders together is conserved.
  EXPECT_LT((momentum + onHolders).norm(), 1e-6 * impulses);
}

/// A position is a pair of floats, which have 48 bits together.
TEST(LineProjection, LeavesHeldParticlesWhereTheyAre) {
  Generator random(7);
  Scheduled cloth(clothOf(9, 8, 0.05, fabricPreset("cotton")));
  disturb(random, cloth);
  SpringLines lines;
  lines.build(cloth.model, cloth.particles.slotOf);
  LineProjection projection;
  projection.prepare(lines, cloth.model.springs);
  projection.setStep(kStep);
  VectorArray pull;
  pull.resize(cloth.particles.mass.size());
  const ScalarArray held(cloth.particles.mass.size(), 0.0);
  const Particles before = cloth.particles;
  projection.project(lines, held, cloth.particles, pull);
  for (std::size_t k = 0; k < held.size(); ++k) {
    const Vec3 x = before.x.at(k);
    EXPECT_LT((cloth.particles.x.at(k) - x).norm(), 1e-14 * x.norm());
  }
}

TEST(LineProjection, IsTheDenseSolveOfEveryLine) {
  Generator random(3);
  Scheduled cloth(clothOf(13, 9, 0.05, fabricPreset("cotton")));
  expectIsTheDenseSolve(random, cloth);
}

TEST(LineProjection, IsTheDenseSolveOfEveryLineWithDashpots) {
  Generator random(4);
  Fabric fabric = fabricPreset("silk");
  fabric.damping = 1e-4;
  Scheduled cloth(clothOf(10, 12, 0.05, fabric));
  expectIsTheDenseSolve(random, cloth);
}

TEST(LineProjection, IsTheDenseSolveAfterCuts) {
  Generator random(6);
  Scheduled cloth(clothOf(12, 12, 0.05, fabricPreset("cotton")));
  for (int edit = 0; edit < 4; ++edit) {
    cloth.edit(random);
    expectIsTheDenseSolve(random, cloth);
  }
}

}  // namespace
}  // namespace cloth_sim
