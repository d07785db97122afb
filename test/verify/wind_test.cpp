/// \file Any wind: every method keeps a flag together that a gale of up to 500 m/s blows at.

#include <gtest/gtest.h>

#include <algorithm>

#include "cloth_sim/sim/simulation.h"
#include "fewer_cases.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using namespace verify_support;

/// A cotton of half a metre that hangs from its upper row, in a wind across it.
Scene flag(const std::string& method, double speed) {
  const bool isCheap = std::isinf(findSolver(method).stabilityLimit);
  const int cells = isCheap ? 16 : 4;
  Scene scene;
  scene.cloths[0] = clothOf(cells + 1, cells + 1, 0.5 / cells, fabricPreset("cotton"));
  scene.cloths[0].pose.orientation = Quat(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX()));
  for (int column = 0; column <= cells; ++column) {
    scene.cloths[0].pins.push_back({column, cells});
  }
  scene.wind = Wind{Vec3(0.0, speed, 2.0)};
  scene.solver.method = method;
  scene.solver.dt = 1.0 / 60.0;
  scene.solver.parameters = completeParameters(findSolver(method), {});
  if (!isCheap) {  // with dashpots, forward Euler is stable too
    Fabric& fabric = scene.cloths[0].fabric;
    fabric.tensileWarp = fabric.tensileWeft = 50.0;
    fabric.damping = 2e-3;
    scene.solver.parameters["substeps"] = 512.0;  // the gale stretches faces, and stiffens springs
  }
  return scene;
}

/// By method and speed of the wind [m/s].
class WindSpeeds : public testing::TestWithParam<std::tuple<std::string, double>> {};

INSTANTIATE_TEST_SUITE_P(Registry, WindSpeeds,
                         testing::Combine(testing::ValuesIn(solverNames()),
                                          testing::ValuesIn(fewerCasesOf<double>({5.0, 15.0, 50.0,
                                                                                  200.0, 500.0}))));

TEST_P(WindSpeeds, DoNotMakeASimulationDiverge) {
  const auto& [method, speed] = GetParam();
  Simulation simulation(flag(method, speed));
  double fastest = 0.0;
  while (simulation.time() < 0.5 && !simulation.failed()) {
    simulation.step();
    for (const Vec3& v : simulation.state().v) fastest = std::max(fastest, v.norm());
  }
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  // A corner that is slung around by cloth in the wind is faster than the wind, but not by much:
  // the velocities of a method that diverges grow to 10 km/s within a few steps.
  record("fastest_over_wind", fastest / speed);
  EXPECT_LT(fastest, 20.0 * speed);
}

}  // namespace
}  // namespace cloth_sim
