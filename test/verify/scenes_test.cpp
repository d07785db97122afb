/// \file Simulations against statics and Coulomb friction, with every registered method.

#include <gtest/gtest.h>

#include <cmath>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "unit/core_support.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kGravity = 9.81;  // [m/s^2]

class Scenes : public testing::TestWithParam<std::string> {
 protected:
  /// Inserts the method of the test into a scene.
  Simulation simulate(const std::string& yaml, std::vector<std::string> overrides = {}) const {
    overrides.push_back("solver.method=" + GetParam());
    return Simulation(parseScene(yaml, "test.yaml", overrides));
  }
};

INSTANTIATE_TEST_SUITE_P(Registry, Scenes, testing::ValuesIn(boundedSolverNames()),
                         [](const auto& test) { return test.param; });

void run(Simulation& simulation, double seconds) {
  const double end = simulation.time() + seconds - 1e-9;
  while (simulation.time() < end) {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
  }
}

// ---- weight -------------------------------------------------------------------------------------

// A soft knit, so that 40 substeps resolve it for every method.
const char* const kHanging = R"(
cloth:
  size: [0.3, 0.3]
  particles: [8, 8]
  pose: {position: [0, 0, 1], rpy: [1.5707963267948966, 0, 0]}
  fabric: interlock
solver: {dt: 0.0166666666666666667, substeps: 40}
drag: 3.0
)";

TEST_P(Scenes, PinsBearTheWeightOfAHangingCloth) {
  // The first swing has died away as exp(-drag t / 2) = exp(-9) = 1e-4 of the weight.
  Simulation simulation = simulate(kHanging, {"cloth.pins=[corner_01, corner_11]"});
  run(simulation, 6.0);
  const double weight = totalMass(simulation.model()) * kGravity;
  Vec3 sum = Vec3::Zero();
  for (const Vec3& f : simulation.lastReport().reactions) sum += f;
  RecordProperty("pins_over_weight", std::to_string(-sum.z() / weight));
  EXPECT_NEAR(-sum.z() / weight, 1.0, 0.005);
  EXPECT_LT(sum.head<2>().norm(), 0.005 * weight);
  EXPECT_LT(meanSpeed(simulation.state()), 1e-3);
}

TEST_P(Scenes, ClampsBearTheWeightOfAHangingCloth) {
  Simulation simulation = simulate(
      kHanging, {"clamps={left: {patch: {particle: [1, 6], radius: 1}, gap_open: 0.1, gap_closed: "
                 "0.01, closing_speed: 5.0, pose: {position: [-0.1, 0, 1.1], rpy: [1.5707963, 0, "
                 "0]}}, right: {patch: {particle: [6, 6], radius: 1}, gap_open: 0.1, gap_closed: "
                 "0.01, closing_speed: 5.0, pose: {position: [0.1, 0, 1.1], rpy: [1.5707963, 0, "
                 "0]}}}",
                 "phases=[{name: hold, clamps: {all: {grasp: true}}, timeout: 100}]"});
  run(simulation, 6.0);
  Wrench both;
  for (const Clamp& clamp : simulation.clamps()) {
    EXPECT_EQ(clamp.state(), ClampState::kClosed);
    EXPECT_EQ(clamp.held().size(), 9U);
    both.force += clamp.wrench().force;
  }
  const double weight = totalMass(simulation.model()) * kGravity;
  RecordProperty("clamps_over_weight", std::to_string(-both.force.z() / weight));
  EXPECT_NEAR(-both.force.z() / weight, 1.0, 0.005);
  EXPECT_LT(both.force.head<2>().norm(), 0.01 * weight);
}

// ---- a strip under its own weight ---------------------------------------------------------------

TEST_P(Scenes, AStripStretchesUnderItsOwnWeight) {
  if (!findSolver(GetParam()).followsFabric) GTEST_SKIP() << "its stiffness is its own";
  // Tension at height s above the lower end is rho g w s, strain rho g s / K: in all
  // rho g L^2 / (2 K). Lumped masses give the same (the tension of each segment is that of its
  // middle). Projection lengthens a spring by T (w_a + w_b) h^2 more (docs/model.md): here
  // (w_a + w_b) k h^2 = 1e-3 at h = 1e-4 s.
  const double density = 0.1, stiffness = 50.0, length = 1.0;
  Simulation simulation = simulate(R"(
cloth:
  size: [0.1, 1.0]
  particles: [3, 11]
  pose: {position: [0, 0, 1], rpy: [1.5707963267948966, 0, 0]}
  fabric: {areal_density: 0.1, tensile_warp: 50, tensile_weft: 50, shear: 0, bending: 0, damping: 0}
  shear: false
  pins: [last_row]
solver: {dt: 0.01, substeps: 100}
drag: 15.0
)");
  run(simulation, 3.0);
  double elongation = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 d = simulation.state().x[i] - simulation.state().x[30 + i];
    elongation += (d.norm() - length) / 3.0;
  }
  const double expected = density * kGravity * length * length / (2.0 * stiffness);
  RecordProperty("elongation_over_closed_form", std::to_string(elongation / expected));
  EXPECT_NEAR(elongation / expected, 1.0, 3e-3);
}

// ---- friction -----------------------------------------------------------------------------------

/// Returns the distance by which the middle of the cloth has slid [m].
double slide(const Simulation& simulation, const Vec3& start) {
  return (centreOfMass(simulation.model(), simulation.state()) - start).norm();
}

/// A cloth that starts at rest on a plane tilted by `angle`, with a friction coefficient of 0.5.
std::string incline(double angle) {
  const Quat turn(Eigen::AngleAxisd(angle, Vec3::UnitY()));
  const Vec3 up = turn * Vec3(0.0, 0.0, 0.5 * fabricPreset("interlock").thickness);
  const auto text = [](double x) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.17g", x);
    return std::string(buffer);
  };
  const std::string tilt = "rpy: [0, " + text(angle) + ", 0]";
  return "cloth:\n  size: [0.3, 0.3]\n  particles: [7, 7]\n  fabric: interlock\n  pose: {position: "
         "[" +
         text(up.x()) + ", 0, " + text(up.z()) + "], " + tilt +
         "}\nsolver: {dt: 0.0166666666666666667, substeps: 40}\nobstacles: {slope: {type: plane, " +
         tilt + ", friction: 0.5}}\n";
}

TEST_P(Scenes, ClothSticksJustBelowTheAngleOfFriction) {
  // Real static friction: no creep, so only the rounding of positions is allowed.
  Simulation simulation = simulate(incline(std::atan(0.5) - 0.01));
  const Vec3 start = centreOfMass(simulation.model(), simulation.state());
  run(simulation, 1.0);
  EXPECT_LT(slide(simulation, start), 1e-9);
}

TEST_P(Scenes, ClothSlidesJustAboveTheAngleOfFriction) {
  // a = g (sin - mu cos); with N substeps s is a T^2 / 2 up to 1 + 1/N, N = 2400.
  const double angle = std::atan(0.5) + 0.01;
  Simulation simulation = simulate(incline(angle));
  const Vec3 start = centreOfMass(simulation.model(), simulation.state());
  run(simulation, 1.0);
  const double expected = 0.5 * kGravity * (std::sin(angle) - 0.5 * std::cos(angle));
  RecordProperty("slide_over_expected", std::to_string(slide(simulation, start) / expected));
  EXPECT_NEAR(slide(simulation, start) / expected, 1.0, 2e-3);
}

// ---- tunnelling ---------------------------------------------------------------------------------

TEST_P(Scenes, NothingPassesTheTableOrTheSphereAt20MetresPerSecond) {
  // The obstacles of the shipped tearing run, with its step of 1/60 s: 0.33 m in one step.
  Scene scene = loadScene(shipped("tear_seam"));
  scene.clamps.clear();
  scene.phases.clear();
  scene.tearing = TearingSettings{};
  scene.cloths[0] = clothOf(9, 9, 0.05, fabricPreset("interlock"));
  scene.solver.method = GetParam();
  scene.solver.parameters = completeParameters(findSolver(GetParam()), {{"substeps", 40.0}});
  int touched = 0;
  for (const Vec3& from : {Vec3(0.0, 0.0, 1.0), Vec3(0.4, 0.1, 0.7), Vec3(0.5, 0.0, 0.35)}) {
    scene.cloths[0].pose.position = from;
    // At the table, or past it to the side into the sphere.
    for (const Vec3& velocity : {Vec3(0.0, 0.0, -20.0), Vec3(-15.0, 0.0, -13.0)}) {
      scene.cloths[0].velocity = velocity;
      Simulation simulation(scene);
      for (int k = 0; k < 15; ++k) {
        simulation.step();
        ASSERT_FALSE(simulation.failed()) << simulation.failure();
        for (const Collider& collider : simulation.colliders().all()) {
          for (const Vec3& x : simulation.state().x) {
            // Where the sphere stands on the table they leave less than the cloth's thickness t for
            // it (r < sqrt(2 R t) = 12 mm): who slides in there is squeezed by both.
            const double room = x.head<2>().norm() < 0.015 ? 1e-3 : 1e-6;
            EXPECT_GT(collider.gap(x, simulation.time()), -room) << collider.obstacle().name;
          }
        }
        for (const ContactCandidates& c : simulation.contacts().candidates) {
          touched += c.impulse.linear.norm() > 0.0 ? 1 : 0;
        }
      }
      for (const Vec3& x : simulation.state().x) {
        const bool beside = std::abs(x.x()) > 0.8 || std::abs(x.y()) > 0.8;
        EXPECT_TRUE(beside || x.z() > 0.0) << "under the table";
      }
    }
  }
  EXPECT_GT(touched, 20);
}

}  // namespace
}  // namespace cloth_sim
