/// \file A cloth of the size that people run is as stiff as its fabric says.

#include <gtest/gtest.h>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {
namespace {

/// A cotton of 128 x 128 that hangs from its upper edge, strongly damped by the air.
Simulation hangingSheet(const std::string& method, int substeps) {
  return Simulation(parseScene(R"(
cloth:
  size: [1.0, 1.0]
  particles: [128, 128]
  pose: {position: [0, 0, 1], rpy: [1.5707963267948966, 0, 0]}
  fabric: {preset: cotton}
  pins: [last_row]
solver: {method: )" + method + R"(, dt: 0.016666666666666666, substeps: )" +
                                   std::to_string(substeps) + R"(}
drag: 20
phases: [{name: hang, timeout: 2}]
)",
                               "sheet.yaml"));
}

/// Largest strain when the sheet has come to rest [-].
double largestStrain(const std::string& method, int substeps) {
  Simulation simulation = hangingSheet(method, substeps);
  for (int k = 0; k < 60; ++k) simulation.step();
  EXPECT_FALSE(simulation.failed()) << simulation.failure();
  return simulation.observeMaxStretch() - 1.0;
}

/// The weight below a line across the sheet pulls at it. The uppermost springs along the sheet have
/// the strain rho g H / K = 0.1036 * 9.81 * 1 / 2800 = 3.6e-4, less half a cell in 128; the sheet
/// also becomes narrower, which the pinned edge prevents, so up to K G / (q1 q2), a hundredth, is
/// missing there.
constexpr double kStrain = 0.1036 * 9.81 / 2800.0;

TEST(FabricAtSize, LinesBearTheWeightOfASheetWithTheStrainOfTheFabric) {
  EXPECT_NEAR(largestStrain("line_xpbd", 20), kStrain, 0.1 * kStrain);
}

/// Where the single springs of xpbd end with the same number of substeps, for comparison: each
/// gives way by T h^2 (w_a + w_b), which here is a strain of some tenths, in place of some 1e-4.
TEST(FabricAtSize, SingleSpringsWithAsManySubstepsAreTwoOrdersSofter) {
  EXPECT_GT(largestStrain("xpbd", 20), 50.0 * kStrain);
}

}  // namespace
}  // namespace cloth_sim
