/// \file `projective` with one solve per frame on obstacles. Obstacles act after the solve; the
/// load that they bore in the last substep takes part in it (src/constraints/contact_warm_start.h).

#include <gtest/gtest.h>

#include <algorithm>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

constexpr double kWeight = 0.2 * verify_support::kGravity;  // [N]

/// A scene with a cloth of 1 m and 0.2 kg that falls flat from `height` on the given obstacles.
Simulation falling(double height, const std::string& obstacles) {
  return Simulation(parseScene("cloth:\n  particles: [64, 64]\n  pose: {position: [0, 0, " +
                                   std::to_string(height) +
                                   "]}\n  fabric: {preset: cotton, areal_density: 0.2}\n"
                                   "drag: 0.5\n"
                                   "solver: {method: projective, substeps: 1, iterations: 1}\n"
                                   "obstacles:\n  ground: {type: plane}\n" +
                                   obstacles,
                               "falling"));
}

const std::string kBall =
    "  ball: {type: sphere, radius: 0.25, position: [0, 0, 0.35], friction: 0.5}\n";

void run(Simulation& simulation, double seconds) {
  const double end = simulation.time() + seconds - 1e-9;
  while (simulation.time() < end) {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
  }
}

double borne(const Simulation& simulation) {
  double force = 0.0;
  for (const ContactCandidates& near : simulation.contacts().candidates)
    force += near.impulse.linear.z();
  return -force * 60.0;
}

/// Returns the strain of the column that is stretched most.
double columnStretch(const Simulation& simulation) {
  const Grid& grid = *simulation.model().cloths[0].grid;
  double worst = 0.0;
  for (int column = 0; column < grid.columns; ++column) {
    double length = 0.0;
    for (int row = 0; row + 1 < grid.rows; ++row) {
      const VertexData<Vec3>& x = simulation.state().x;
      length += (x[grid.vertex(column, row + 1)] - x[grid.vertex(column, row)]).norm();
    }
    worst = std::max(worst, length / grid.height - 1.0);
  }
  return worst;
}

TEST(ProjectiveDrape, StrainsLittleOnASphere) {
  // Without the forces of the last substep: 0.12.
  Simulation simulation = falling(0.7, kBall);
  run(simulation, 5.0);
  RecordProperty("column", std::to_string(columnStretch(simulation)));
  EXPECT_LT(columnStretch(simulation), 0.03);
}

TEST(ProjectiveDrape, ObstaclesBearTheWeight) {
  Simulation simulation = falling(0.7, kBall);
  run(simulation, 5.0);
  double mean = 0.0;
  for (int k = 0; k < 60; ++k) {
    run(simulation, 1.0 / 60.0);
    mean += borne(simulation) / 60.0;
  }
  RecordProperty("of_the_weight", std::to_string(mean / kWeight));
  EXPECT_NEAR(mean, kWeight, 0.02 * kWeight);
}

TEST(ProjectiveDrape, WhatFallsFlatDoesNotBounce) {
  Simulation simulation = falling(0.5, "");
  run(simulation, 0.4);  // it arrives after 0.32 s
  double highest = 0.0;
  for (int k = 0; k < 30; ++k) {
    run(simulation, 1.0 / 60.0);
    for (const Vec3& x : simulation.state().x) highest = std::max(highest, x.z());
  }
  EXPECT_LT(highest, 1e-3);
}

TEST(ProjectiveDrape, DoesNotLeaveASphereOnceItIsThere) {
  Simulation simulation = falling(0.7, kBall);
  run(simulation, 1.0);
  for (int k = 0; k < 60; ++k) {
    run(simulation, 1.0 / 60.0);
    EXPECT_GT(borne(simulation), 0.3 * kWeight) << simulation.time();
  }
}

}  // namespace
}  // namespace cloth_sim
