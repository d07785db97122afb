/// \file The stiffness matrix of bending gives the forces of the elements, several rows at a time,
/// and impulses that are given at once stay stable.

#include "linalg/bend_matrix.h"  // private: products are compared with sums over elements

#include <gtest/gtest.h>

#include "cloth/bending_row_sums.h"
#include "cloth_sim/threads/thread_limit.h"
#include "cloth_sim/threads/thread_pool.h"
#include "linalg/impulse_polynomial.h"
#include "linalg/vector_operations.h"
#include "unit/scheduled.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kSpacing = 0.008;  // [m]

ClothSpec plateOf(int columns, int rows) {
  ClothSpec spec = clothOf(columns, rows, kSpacing, fabricPreset("cotton"));
  spec.plate = true;
  return spec;
}

/// Particles of a model at random positions, and inverse inertia that differs from one to the next.
struct Laid {
  explicit Laid(const Model& model, std::uint64_t seed) {
    Generator random(seed);
    particles.layOut(model);
    const auto slots = static_cast<std::size_t>(particles.slots);
    inverseInertia.assign(slots, 0.0);
    for (VertexId v = 0; v < model.particleCount(); ++v) {
      const auto slot = static_cast<std::size_t>(particles.slotOf[v]);
      particles.x.set(slot, randomVector(random, 1.0));
      inverseInertia[slot] = v % 5 == 0 ? 0.0 : uniform(random, 1.0, 2.0) / model.mass[v];
    }
  }
  Particles particles;
  ScalarArray inverseInertia;
};

/// The forces of the elements, one after the other [N].
VectorArray forcesOfElements(const Model& model, const Particles& particles) {
  VectorArray force;
  setZero(static_cast<std::size_t>(particles.slots), force);
  for (const PlateElement& element : model.bending.elements()) {
    const auto slotOf = [&](int k) {
      return static_cast<std::size_t>(
          particles.slotOf[element.vertex[static_cast<std::size_t>(k)]]);
    };
    Vec3 curvature = Vec3::Zero();
    for (int k = 0; k < element.count; ++k) {
      curvature += element.weight[static_cast<std::size_t>(k)] * particles.x.at(slotOf(k));
    }
    for (int k = 0; k < element.count; ++k) {
      const double weight = element.weight[static_cast<std::size_t>(k)];
      force.set(slotOf(k), force.at(slotOf(k)) - element.stiffness * weight * curvature);
    }
  }
  return force;
}

void expectForcesOfElements(const Model& model) {
  const Laid laid(model, 7);
  const Particles& p = laid.particles;
  BendMatrix matrix;
  matrix.build(model, p);
  const VectorArray expected = forcesOfElements(model, p);
  VectorArray force, moved = p.x;
  setZero(expected.x.size(), force);
  matrix.addProduct(-1.0, p.x, force);
  double largest = 0.0;
  for (std::size_t slot = 0; slot < expected.x.size(); ++slot) {
    largest = std::max(largest, expected.at(slot).norm());
  }
  const double square = 1e-6, rounding = 1e-12 * largest;
  matrix.displace(square, laid.inverseInertia, p.x, p.x, moved);
  for (std::size_t slot = 0; slot < expected.x.size(); ++slot) {
    EXPECT_LT((force.at(slot) - expected.at(slot)).norm(), rounding) << "slot " << slot;
    EXPECT_LT((matrix.rowProduct(slot, p.x) + expected.at(slot)).norm(), rounding);
    const double scale = square * laid.inverseInertia[slot];
    const Vec3 by = moved.at(slot) - p.x.at(slot) - scale * expected.at(slot);
    EXPECT_LT(by.norm(), scale * rounding + 1e-15) << "slot " << slot;
  }
}

TEST(BendMatrix, GivesTheForcesOfTheElementsOnGrids) {
  for (const int columns : {3, 8, 37, 70}) expectForcesOfElements(buildModel(plateOf(columns, 9)));
}

TEST(BendMatrix, GivesTheForcesOfTheElementsOnCutAndRefinedMeshes) {
  Generator random(3);
  Scheduled cloth(plateOf(40, 12));
  for (int k = 0; k < 6; ++k) cloth.edit(random);
  expectForcesOfElements(cloth.model);
}

TEST(BendMatrix, GivesTheSameBitsOnTwoThreads) {
  const Model model = buildModel(plateOf(96, 96));
  const Laid laid(model, 9);
  BendMatrix matrix;
  matrix.build(model, laid.particles);
  const auto displaced = [&](int threads) {
    const ThreadLimit limit(threads);
    ThreadPool pool;
    const ThreadPool::ParallelRegion region(pool);
    VectorArray moved = laid.particles.x;
    matrix.displace(1e-6, laid.inverseInertia, laid.particles.x, laid.particles.x, moved);
    return moved;
  };
  const VectorArray one = displaced(1), two = displaced(2);
  EXPECT_EQ(one.x, two.x);
  EXPECT_EQ(one.y, two.y);
  EXPECT_EQ(one.z, two.z);
}

/// The eigenvalue of W K that power iteration finds from a random start [1/s^2].
double fastestMode(const BendMatrix& matrix, const ScalarArray& w, VectorArray y) {
  VectorArray next = y;
  double eigenvalue = 0.0;
  for (int k = 0; k < 200; ++k) {
    VectorArray zero;
    setZero(y.x.size(), zero);
    matrix.displace(-1.0, w, y, zero, next);
    eigenvalue = std::sqrt(dot(next, next) / dot(y, y));
    setZero(y.x.size(), y);
    addScaled(1.0 / eigenvalue, next, y);
  }
  return eigenvalue;
}

TEST(BendMatrix, GershgorinsCirclesBoundTheFastestModeClosely) {
  const Model model = buildModel(plateOf(33, 33));
  const Laid laid(model, 11);
  BendMatrix matrix;
  matrix.build(model, laid.particles);
  ScalarArray w(laid.inverseInertia.size(), 0.0);
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    w[static_cast<std::size_t>(laid.particles.slotOf[v])] = 1.0 / model.mass[v];
  }
  std::vector<double> scale;
  for (const double mass : model.mass.values()) scale.push_back(1.0 / std::sqrt(mass));
  const std::vector<double> circles = bendingRowSums(model, scale);
  const double bound = *std::max_element(circles.begin(), circles.end());
  const double fastest = fastestMode(matrix, w, laid.particles.x);
  EXPECT_LE(fastest, bound);
  EXPECT_GT(fastest, 0.9 * bound);
}

/// A free plate without gravity whose bending is as stiff as it may be for its impulses to be
/// given at once: noise dies away.
void expectNoiseDies(const std::string& method, double h) {
  ClothSpec spec = plateOf(24, 24);
  const double mass = spec.fabric.arealDensity * kSpacing * kSpacing;
  const double stiffest = 64.0 / (kSpacing * kSpacing * mass);  // over the rigidity
  const double most = ImpulsePolynomial(1).limit();
  spec.fabric.bending = 0.99 * most / (h * h * stiffest);
  const Model model = buildModel(spec);
  const int substeps = 4;
  std::unique_ptr<Solver> solver = makeSolver(findSolver(method), model, substeps);
  State state = shakenState(model, 1e-5, 0.05, 5);
  Contacts contacts;
  Controls controls;
  controls.gravity = Vec3::Zero();
  const auto kinetic = [&] {
    double sum = 0.0;
    for (VertexId v = 0; v < model.particleCount(); ++v) {
      sum += 0.5 * model.mass[v] * state.v[v].squaredNorm();
    }
    return sum;
  };
  const double before = kinetic();
  for (int k = 0; k < 400; ++k) {
    ASSERT_EQ(solver->step(model, state, controls, contacts, {substeps * h}).status,
              StepStatus::kOk);
  }
  EXPECT_LT(kinetic(), 0.5 * before) << method << " " << h;
}

TEST(PlateAtOnce, NoiseDiesAwayAtTheStiffestThatIsGivenAtOnce) {
  expectNoiseDies("xpbd", 1.0 / 1200.0);
  expectNoiseDies("line_xpbd", 1.0 / 500.0);
  expectNoiseDies("line_xpbd", 1.0 / 2400.0);
}

}  // namespace
}  // namespace cloth_sim
