/// \file The longest stable step of explicit methods, and how surgery changes it.

#include "cloth_sim/cloth/stable_step.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "cloth_sim/surgery/operation.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

/// Largest eigenvalue of M^-1/2 K M^-1/2 of the springs at rest [1/s^2], in the plane of the cloth.
double largestEigenvalue(const Model& model, const State& state) {
  const Eigen::Index n = 3 * model.particleCount();
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n);
  for (const Spring& spring : model.springs.slots()) {
    if (!spring.exists()) continue;
    const Vec3 d = (state.x[spring.b] - state.x[spring.a]).normalized();
    const Eigen::Matrix3d block = spring.stiffness * d * d.transpose();
    const Eigen::Index a = 3 * spring.a;
    const Eigen::Index b = 3 * spring.b;
    k.block<3, 3>(a, a) += block;
    k.block<3, 3>(b, b) += block;
    k.block<3, 3>(a, b) -= block;
    k.block<3, 3>(b, a) -= block;
  }
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    const double root = 1.0 / std::sqrt(model.mass[v]);
    k.middleRows<3>(3 * v) *= root;
    k.middleCols<3>(3 * v) *= root;
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

SurgeryLimits limitsOf(const Model& model) {
  SurgeryLimits limits;
  limits.shape.minEdge = 0.05 * shortestEdge(model.mesh);
  return limits;
}

SurgeryResult cutAlong(const std::vector<Vec3>& path, Model& model, State& state) {
  CutPlan plan;
  plan.paths = findPaths(strokeAlong(path, Vec3::UnitZ(), 1.0), model.mesh, state.x);
  return cut(plan, limitsOf(model), {}, model, state);
}

/// A cloth with a crossing of generic cuts.
void damage(Model& model, State& state) {
  const double w = model.cloths[0].grid->width;
  cutAlong({{-0.1 * w, 0.313 * w, 0.0}, {0.81 * w, 0.672 * w, 0.0}}, model, state);
  cutAlong({{0.287 * w, -0.1 * w, 0.0}, {0.614 * w, 0.913 * w, 0.0}}, model, state);
}

struct Cloth {
  const char* name;
  const char* fabric;  ///< "" for raw springs
  bool shear;
  bool bend;
  bool cut;
};

class StableStep : public testing::TestWithParam<Cloth> {
 protected:
  StableStep() {
    const Cloth& cloth = GetParam();
    const bool raw = std::string(cloth.fabric).empty();
    ClothSpec spec = clothOf(7, 7, 0.05, fabricPreset(raw ? "silk" : cloth.fabric));
    spec.fabric.damping = 0.0;
    spec.springs = {cloth.shear, cloth.bend};
    if (raw) spec.raw = RawSprings{{80.0, 40.0, 5.0}, false, 0.0};
    model_ = buildModel(spec);
    state_ = flatState(model_);
    if (cloth.cut) damage(model_, state_);
  }
  Model model_;
  State state_;
};

INSTANTIATE_TEST_SUITE_P(Cloths, StableStep,
                         testing::Values(Cloth{"Cotton", "cotton", true, true, false},
                                         Cloth{"DenimWithoutShear", "denim", false, true, false},
                                         Cloth{"SilkWithoutBend", "silk", true, false, false},
                                         Cloth{"Raw", "", true, true, false},
                                         Cloth{"CottonCut", "cotton", true, true, true},
                                         Cloth{"InterlockCut", "interlock", true, true, true},
                                         Cloth{"DenimWithoutShearCut", "denim", false, true, true},
                                         Cloth{"RawCut", "", true, true, true}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(StableStep, IsALowerBoundWithinAFactorOfTwo) {
  // Without damping, symplectic Euler and Verlet are stable up to h = 2 / omega.
  const double exact = 2.0 / std::sqrt(largestEigenvalue(model_, state_));
  const double bound = stableStep(model_);
  EXPECT_LE(bound, exact * (1.0 + 1e-12));
  EXPECT_GE(bound, 0.5 * exact);
}

TEST(StableStepBound, OfTwoParticlesIsExact) {
  // A single spring between equal masses: omega^2 = 2 k / m, and the circles give the same.
  Model model;
  model.mesh = TriangleMesh({{0, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}});
  RawSprings raw{{100.0, 0.0, 0.0}, false, 0.0};
  model.springs = SpringNetwork(model.mesh, raw, {false, false});
  setParticleMasses(0.25, 0, model);
  // Two springs at a right angle meet at vertex 0; the bound adds them up.
  EXPECT_DOUBLE_EQ(stableStep(model), 2.0 / std::sqrt(2.0 * 200.0 / 0.25));
  // h^2 omega^2 + 2 h tau omega^2 = 4 with damping.
  raw.dashpot = 3.0;
  model.springs = SpringNetwork(model.mesh, raw, {false, false});
  const double h = stableStep(model);
  const double squared = 2.0 * 200.0 / 0.25;
  EXPECT_NEAR(h * h * squared + 2.0 * h * 0.03 * squared, 4.0, 1e-12);
}

TEST(StableStepBound, OfAClothWithoutSpringsIsInfinite) {
  Model model;
  model.mesh = TriangleMesh({{0, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}});
  model.springs = SpringNetwork(model.mesh, RawSprings{}, {false, false});
  setParticleMasses(0.25, 0, model);
  EXPECT_EQ(stableStep(model), std::numeric_limits<double>::infinity());
}

/// Returns the largest eigenvalue [1/s^2] of the mass-weighted stiffness at `state`. Compressed
/// springs count without the part that makes them buckle, as in estimateFastestMode.
double largestEigenvalueAt(const Model& model, const State& state) {
  const int n = 3 * model.particleCount();
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n);
  const auto add = [&](VertexId a, VertexId b, const Eigen::Matrix3d& block) {
    k.block<3, 3>(3 * a, 3 * b) += block / std::sqrt(model.mass[a] * model.mass[b]);
  };
  for (const Spring& spring : model.springs.slots()) {
    const Vec3 d = state.x[spring.b] - state.x[spring.a];
    const Eigen::Matrix3d along = d * d.transpose() / d.squaredNorm();
    const double tension = std::max(0.0, 1.0 - spring.restLength / d.norm());
    const Eigen::Matrix3d block =
        spring.stiffness * (along + tension * (Eigen::Matrix3d::Identity() - along));
    add(spring.a, spring.a, block);
    add(spring.b, spring.b, block);
    add(spring.a, spring.b, -block);
    add(spring.b, spring.a, -block);
  }
  for (const PlateElement& element : model.bending.elements()) {
    for (int i = 0; i < element.count; ++i) {
      for (int j = 0; j < element.count; ++j) {
        add(element.vertex[i], element.vertex[j],
            element.stiffness * element.weight[i] * element.weight[j] *
                Eigen::Matrix3d::Identity());
      }
    }
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k).eigenvalues().maxCoeff();
}

TEST(FastestModeEstimate, IsTheLargestEigenvalueWithinItsMargin) {
  // Against a dense eigenvalue solver; from a flat and a crumpled state, with either bending.
  for (const bool plate : {false, true}) {
    for (const double shake : {0.0, 0.02}) {
      ClothSpec spec = clothOf(7, 6, 0.05, fabricPreset("denim"));
      spec.plate = plate;
      spec.springs.bend = !plate;
      spec.fabric.bending = 1e-3;
      const Model model = buildModel(spec);
      const State state = shakenState(model, shake, 0.0, 4);
      const double exact = largestEigenvalueAt(model, state);
      const FastestMode estimate = estimateFastestMode(model, state);
      EXPECT_GE(estimate.squared, exact) << plate << shake;
      EXPECT_LE(estimate.squared, 1.1 * exact * (1.0 + 1e-9)) << plate << shake;
      EXPECT_GE(boundFastestMode(model).squared, exact);
    }
  }
}

TEST(StableStepBound, CutsLowerItNoFurtherThanTheShortestEdgeAllows) {
  // Without bending. Faces keep angles from a = 5 degrees and edges from e = minEdge on.
  // An edge of length l >= e whose faces have the area A has a spring of k <= q A / l^2, or
  // G A / (2 l^2 c^2 s^2) <= 4 G A / l^2 if it is a bias (c s >= sqrt(2) / 4 up to 22.5 degrees
  // from the threads). Each face around a particle is under two of the edges there: with S their
  // area, these sum up to at most 2 (q + 4 G) S / e^2. Springs across the outer edge of a face also
  // stand on the face beyond. They are longer than both heights, and a height is at least half the
  // base times tan(a): A / l^2 <= 2 / tan(a), so that n faces have at most 8 n G / tan(a). S is n
  // e^2 sin(a) / 2 at least. The mass is rho S / 3, and omega^2 <= 2 sum k / m
  //   <= (6 / rho) (2 (q + 4 G) / e^2 + 16 G / (e^2 sin(a) tan(a))).
  const double a = ShapeLimits{}.minAngle;
  for (const char* name : {"cotton", "denim", "interlock", "silk"}) {
    ClothSpec spec = clothOf(12, 12, 0.03, fabricPreset(name));
    spec.fabric.damping = 0.0;
    spec.fabric.bending = 0.0;
    Model model = buildModel(spec);
    State state = flatState(model);
    const double e = limitsOf(model).shape.minEdge;
    const double before = stableStep(model);
    damage(model, state);
    const Fabric& f = spec.fabric;
    const double g = f.shear;
    const double ratio = f.tensileWarp / f.tensileWeft;
    const double q = 0.5 * (f.tensileWarp + std::sqrt(f.tensileWarp * f.tensileWarp +
                                                      4.0 * g * g * std::max(ratio, 1.0 / ratio)));
    const double most = 6.0 / f.arealDensity / (e * e) *
                        (2.0 * (q + 4.0 * g) + 16.0 * g / (std::sin(a) * std::tan(a)));
    EXPECT_LT(stableStep(model), before) << name;
    EXPECT_GT(stableStep(model), 2.0 / std::sqrt(most)) << name;
  }
}

TEST(Substeps, RiseAfterACutSoThatTheRunStaysStable) {
  // A cloth in rigid motion, shaken a little; the step is 0.8 of the longest stable one, and the
  // cut lowers that. The energy then swings by no more than 1 / (1 - (h omega / 2)^2) = 1 / 0.36.
  for (const char* method : {"symplectic_euler", "verlet"}) {
    ClothSpec spec = clothOf(9, 9, 0.05, fabricPreset("interlock"));
    spec.fabric.damping = 0.0;
    Model model = buildModel(spec);
    State state = shakenState(model, 1e-4, 0.01, 3);
    const int configured = 4;
    const double first = stableStep(model);
    const double dt = 0.8 * configured * first;
    const auto solver = makeSolver(findSolver(method), model, configured);
    Controls controls;
    controls.gravity = Vec3::Zero();
    Contacts contacts;
    EXPECT_EQ(solver->step(model, state, controls, contacts, {dt}).substeps, configured);

    const SurgeryResult result =
        cutAlong({{-0.1, 0.113, 0.0}, {0.31, 0.172, 0.0}, {0.187, 0.5, 0.0}}, model, state);
    ASSERT_FALSE(result.changes.mesh.empty());
    solver->onModelChanged(model, result.changes);
    ASSERT_LT(stableStep(model), 0.8 * first) << "the cut was to make short edges";
    const auto energy = [&] {
      const Energies e = energies(model, state, Vec3::Zero());
      return e.kinetic + e.elastic;
    };
    const double start = energy();
    for (int k = 0; k < 500; ++k) {
      const StepReport& report = solver->step(model, state, controls, contacts, {dt});
      ASSERT_EQ(report.status, StepStatus::kOk) << method;
      ASSERT_EQ(report.substeps,
                static_cast<int>(std::ceil(configured * first / stableStep(model) - 1e-9)));
      ASSERT_LT(energy(), start / 0.36) << method << ", step " << k;
    }
  }
}

}  // namespace
}  // namespace cloth_sim
