/// \file A rolled strip that is let go keeps the curvature that friction between its yarns holds.

#include <gtest/gtest.h>

#include <cmath>

#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {
namespace {

constexpr double kCell = 2e-3;        // [m]
constexpr double kRigidity = 1e-5;    // [N m]
constexpr double kHysteresis = 6e-4;  // [N]
constexpr double kRolled = 80.0;      // [1/m]: more than HB / B + 2 SlipElement::kSlipCurvature
constexpr int kCells = 16;

/// A strip, three particles across, that is rolled to an arc.
ClothSpec rolledStrip(double hysteresis) {
  auto mesh = std::make_shared<ClothMesh>();
  for (int column = 0; column <= kCells; ++column) {
    const double angle = kRolled * kCell * column;
    for (int row = 0; row < 3; ++row) {
      mesh->material.emplace_back(column * kCell, row * kCell);
      mesh->positions.emplace_back(std::sin(angle) / kRolled, row * kCell,
                                   (1.0 - std::cos(angle)) / kRolled);
    }
  }
  for (VertexId v = 0; v < 3 * kCells; ++v) {
    if (v % 3 == 2) continue;
    mesh->faces.push_back({v, v + 3, v + 4});
    mesh->faces.push_back({v, v + 4, v + 1});
  }
  ClothSpec spec;
  spec.mesh = mesh;
  spec.width = kCells * kCell;
  spec.height = 2.0 * kCell;
  spec.fabric.arealDensity = 0.1;
  spec.fabric.bending = kRigidity;
  spec.fabric.bendingHysteresis = hysteresis;
  spec.fabric.tensileWarp = spec.fabric.tensileWeft = 200.0;
  spec.fabric.shear = 50.0;
  spec.springs = {true, false};
  spec.plate = true;
  return spec;
}

/// Mean curvature of the inner half of the strip, along its middle row [1/m].
double curvatureOf(const State& state) {
  double sum = 0.0;
  int count = 0;
  for (int column = kCells / 4; column <= 3 * kCells / 4; ++column, ++count) {
    const VertexId v = 3 * column + 1;
    const Vec3 second = state.x[v - 3] - 2.0 * state.x[v] + state.x[v + 3];
    sum += second.norm() / (kCell * kCell);
  }
  return sum / count;
}

/// Lets the strip go without gravity, in air so thick that it does not swing past its rest.
double curvatureAtRest(const SolverInfo& info, int substeps, double hysteresis) {
  Scene scene;
  scene.cloths[0] = rolledStrip(hysteresis);
  scene.gravity = Vec3::Zero();
  scene.drag = 4000.0;
  scene.solver.method = info.name;
  scene.solver.dt = 1e-3;
  scene.solver.parameters = completeParameters(info, {{"substeps", 1.0 * substeps}});
  scene.solver.sleep.reset();
  Simulation simulation(scene);
  for (int k = 0; k < 1500; ++k) simulation.step();
  EXPECT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_LT(meanSpeed(simulation.state()), 1e-4);
  return curvatureOf(simulation.state());
}

TEST(BendFriction, AFoldStaysAsFarAsFrictionHoldsIt) {
  // Elastic moment B c against the moment HB of friction, in every section. The three methods
  // differ in how they solve that: one element after the other is right as far as substeps resolve
  // the bending of a cell (omega h = 0.9 here).
  const double held = 0.5 * kHysteresis / kRigidity;
  int methods = 0;
  for (const SolverInfo& info : solverRegistry()) {
    if (!info.hasBendFriction) continue;
    ++methods;
    const bool isImplicit = info.name == "implicit_euler";
    const double curvature = curvatureAtRest(info, isImplicit ? 2 : 40, kHysteresis);
    RecordProperty(info.name, std::to_string(curvature));
    EXPECT_NEAR(curvature / held, 1.0, isImplicit ? 0.01 : 0.03) << info.name;
  }
  EXPECT_EQ(methods, 3);
}

TEST(BendFriction, WithoutItAFoldOpens) {
  EXPECT_LT(curvatureAtRest(findSolver("implicit_euler"), 2, 0.0), 0.1);
}

}  // namespace
}  // namespace cloth_sim
