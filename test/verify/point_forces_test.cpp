/// \file External forces on single particles, with every method.

#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

using testing_support::solverNames;
using verify_support::OverMethods;
using verify_support::Rig;

class PointForces : public OverMethods {};

/// A force m g on each particle acts like gravity. The two runs differ by rounding or, for methods
/// that iterate to a tolerance, by 1e-6 of the displacement.
TEST_P(PointForces, OfEachParticlesWeightAreGravity) {
  Fabric fabric = fabricPreset("silk");
  fabric.tensileWarp = fabric.tensileWeft = 100.0;
  const Model model = buildModel(testing_support::clothOf(6, 5, 0.05, fabric));
  Rig falls(info(), model, {});
  Rig pulled(info(), model, {});
  for (Rig* rig : {&falls, &pulled}) {
    rig->hold(0);
    rig->hold(5);
  }
  pulled.controls.gravity = Vec3::Zero();
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    pulled.controls.forces.push_back({v, model.mass[v] * falls.controls.gravity});
  }
  constexpr double kStep = 1.0 / 2000.0;
  ASSERT_TRUE(falls.run(kStep, 200));
  ASSERT_TRUE(pulled.run(kStep, 200));
  double sag = 0.0;
  for (VertexId v = 0; v < model.particleCount(); ++v) {
    sag = std::max(sag, std::abs(falls.state.x[v].z()));
    EXPECT_LE((falls.state.x[v] - pulled.state.x[v]).norm(), 1e-6);
  }
  EXPECT_GT(sag, 1e-2);
}

INSTANTIATE_TEST_SUITE_P(Methods, PointForces, testing::ValuesIn(solverNames()),
                         [](const auto& method) { return method.param; });

}  // namespace
}  // namespace cloth_sim
