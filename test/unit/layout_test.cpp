/// \file The order of particles in memory does not change results. Sweeps over a grid use
/// contiguous spans; sweeps over any other mesh gather the particles of each spring.

#include <gtest/gtest.h>

#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

State stepped(const std::string& method, const Model& model) {
  const std::unique_ptr<Solver> solver = makeSolver(findSolver(method), model, 3);
  State state = shakenState(model, 0.002, 0.1, 5);
  Controls controls;
  Contacts contacts;
  for (int k = 0; k < 2; ++k) solver->step(model, state, controls, contacts, {1e-4, 1.0});
  return state;
}

/// Runs of every length from the shortest on, and what is left over of rows in every way.
TEST(Layout, SpringsInRunsAreCorrectedToTheSameBitsAsSpringsAnywhere) {
  for (const char* method : {"xpbd", "pbd", "symplectic_euler"}) {
    for (const double damping : {0.0, 0.02}) {
      Fabric fabric = fabricPreset("silk");
      fabric.damping = damping;
      for (int columns = 4; columns <= 40; ++columns) {
        Model model = buildModel(clothOf(columns, 6, 0.01, fabric));
        const State asGrid = stepped(method, model);
        model.cloths[0].grid.reset();
        const State anywhere = stepped(method, model);
        for (VertexId v = 0; v < model.particleCount(); ++v) {
          ASSERT_EQ(asGrid.x[v], anywhere.x[v]) << method << ", " << columns << " columns";
          ASSERT_EQ(asGrid.v[v], anywhere.v[v]) << method << ", " << columns << " columns";
        }
      }
    }
  }
}

}  // namespace
}  // namespace cloth_sim
