/// \file Forces of a cloth that clamps stretch slowly.

#include <gtest/gtest.h>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "cloth_sim/sim/snapshot.h"

namespace cloth_sim {
namespace {

/// Two clamps stretch cotton by a third between their plates, at 0.4 m/s, and wait.
constexpr const char* kPull = R"(
cloth: {size: [0.5, 0.5], particles: [33, 33], fabric: cotton}
drag: 1
clamps:
  left: {patch: {particle: [1, 16], radius: 1}}
  right: {patch: {particle: [31, 16], radius: 1}}
phases:
  - name: grasp
    clamps: {all: {attach: true, grasp: true, speed: 2}}
    until: {clamps: [at_target, closed]}
  - name: pull
    clamps:
      left: {move_by: [-0.08, 0, 0], speed: 0.2}
      right: {move_by: [0.08, 0, 0], speed: 0.2}
    timeout: 0.6
    on_timeout: continue
)";

struct Outcome {
  double force = 0.0;    ///< of a clamp at the end [N]
  double elastic = 0.0;  ///< energy at the end [J]
};

Outcome pullWith(const std::string& solver, bool quasiStatic) {
  const std::string yaml = std::string(kPull) + "solver: " + solver +
                           "\nquasi_static: " + (quasiStatic ? "true" : "false") + "\n";
  Simulation simulation(parseScene(yaml, "pull"));
  for (int k = 0; k < 400 && simulation.script().status() != ScriptStatus::kDone; ++k) {
    simulation.step();
  }
  EXPECT_EQ(simulation.script().status(), ScriptStatus::kDone) << simulation.failure();
  const auto snapshot = simulation.snapshot(Detail::kFigures);
  return {simulation.clamps()[0].wrench().force.norm(), snapshot->figures->energies.elastic};
}

TEST(QuasiStatic, AStretchedClothBearsTheForceOfTheFabric) {
  const Outcome reference = pullWith("{method: verlet, substeps: 400}", false);
  ASSERT_GT(reference.force, 100.0);
  const std::string coarse = "{method: line_xpbd, substeps: 20}";
  const Outcome declared = pullWith(coarse, true);
  EXPECT_NEAR(declared.force / reference.force, 1.0, 0.1);
  EXPECT_NEAR(declared.elastic / reference.elastic, 1.0, 0.05);
  const Outcome undeclared = pullWith(coarse, false);
  EXPECT_LT(undeclared.force, 0.5 * reference.force) << "no need to declare it any more";
}

TEST(QuasiStatic, APhaseDeclaresItFromThereOn) {
  const std::string yaml =
      std::string(kPull) + R"(  - {name: slow, quasi_static: true, timeout: 0.1}
)";
  Simulation simulation(parseScene(yaml, "pull"));
  EXPECT_FALSE(simulation.tuning().quasiStatic);
  ASSERT_TRUE(simulation.apply(SetPhase{"slow"}).success);
  EXPECT_TRUE(simulation.tuning().quasiStatic);
}

}  // namespace
}  // namespace cloth_sim
