/// \file Layers of cloth that is torn: the certificate holds, and the halves come apart and hang
/// freely.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "verify/intersections.h"
#include "verify/verify_support.h"

namespace cloth_sim {
namespace {

/// A cloth of 0.4 m is pulled apart along a seam in its middle, from a notch on.
/// \param particles  along each side.
Simulation tornAlongASeam(int particles) {
  const std::string yaml = R"(
cloth:
  size: [0.4, 0.4]
  particles: [25, 25]
  fabric: cotton
  bending: springs  # they cross a seam that runs along a column of particles
  pose: {position: [0, 0, 0.5]}
drag: 1
self_contact: true
solver: {method: line_xpbd, error: 0.01}
clamps:
  left: {patch: {particle: [1, 12], radius: 1}, max_speed: 2}
  right: {patch: {particle: [23, 12], radius: 1}, max_speed: 2}
tearing: {ratio: 1.2, seam: {path: [[0.2, 0.0], [0.2, 0.4]], half_width: 0.0}}
phases:
  - name: grasp
    clamps: {all: {attach: true, grasp: true, speed: 2}}
    until: {clamps: [at_target, closed]}
  - name: pull
    notch: [[0.2, 0.0], [0.2, 0.127]]
    clamps: {left: {move_by: [-0.2, 0, 0], speed: 1}, right: {move_by: [0.2, 0, 0], speed: 1}}
    until: {pieces: 2}
    timeout: 2
)";
  const std::string count = std::to_string(particles);
  const std::string right = std::to_string(particles - 2);
  const std::string middle = std::to_string(particles / 2);
  return Simulation(parseScene(yaml, "torn",
                               {"cloth.particles=[" + count + ", " + count + "]",
                                "clamps.right.patch.particle=[" + right + ", " + middle + "]",
                                "clamps.left.patch.particle=[1, " + middle + "]"}));
}

class TornLayers : public testing::TestWithParam<int> {};

/// The two pieces are the halves, rather than one and a sliver beside the seam.
TEST_P(TornLayers, KeepTheCertificateAndComeApartInHalves) {
  Simulation simulation = tornAlongASeam(GetParam());
  for (int step = 0; step < 200 && simulation.script().status() != ScriptStatus::kDone; ++step) {
    simulation.step();
    ASSERT_FALSE(simulation.failed()) << simulation.failure();
    ASSERT_EQ(countIntersections(simulation.model(), simulation.state()), 0) << simulation.time();
    EXPECT_EQ(simulation.layerReport()->unproven, 0);
  }
  EXPECT_EQ(simulation.script().status(), ScriptStatus::kDone);
  EXPECT_GT(simulation.broken().torn, 0);
  EXPECT_GT(simulation.broken().cut, 0);
  const auto pieces = simulation.snapshot()->figures->pieces;
  ASSERT_EQ(pieces.size(), 2u);
  for (const auto& piece : pieces) EXPECT_NEAR(piece.restArea, 0.08, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(SeamAlongAndBetweenColumns, TornLayers, testing::Values(25, 24));

/// The halves snap back at some metres a second and crumple. Where faces that could not be kept
/// apart stayed where they were in the world, they nailed the cloth to the air: a strain of 14 and
/// 330,000 motions that were changed, 100,000 of them in the last half second.
TEST(TornLayersThatSnapBack, ComeToHangFreely) {
  Simulation simulation = tornAlongASeam(48);
  while (simulation.script().status() != ScriptStatus::kDone) simulation.step();
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  const double torn = simulation.time();
  std::int64_t truncated = 0;
  double strain = 0.0;
  while (simulation.time() < torn + 1.5) {
    simulation.step();
    if (simulation.time() < torn + 1.0) continue;
    truncated += simulation.layerReport()->truncated;
    strain = std::max(strain, simulation.observeMaxStretch() - 1.0);
  }
  EXPECT_LT(truncated, 1000);
  EXPECT_LT(strain, 0.4);
  verify_support::record("truncated", static_cast<double>(truncated));
  verify_support::record("strain", strain);
}

}  // namespace
}  // namespace cloth_sim
