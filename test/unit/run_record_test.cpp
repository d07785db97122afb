/// \file The record of a run: when the cloth came apart, how hard it pulled.

#include "cloth_sim/sim/run_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth_sim/scene/load.h"

namespace cloth_sim {
namespace {

// Hangs from a clamp, and is cut through below it after 1.5 s.
const char* const kScene = R"(
cloth:
  size: [0.2, 0.2]
  particles: [9, 9]
  pose: {position: [0, 0, 1], rpy: [1.5707963267948966, 0, 0]}
  fabric: interlock
solver: {dt: 0.01, substeps: 10}
drag: 3.0
clamps:
  hand: {pose: {position: [0, 0, 1.09], rpy: [1.5707963267948966, 0, 0]}, plate_size: [0.3, 0.05],
         closing_speed: 20.0}
phases:
  - {name: hold, clamps: {hand: {grasp: true}}, timeout: 1.5}
  - {name: part, notch: [[0, 0.07], [0.2, 0.07]], timeout: 0.2}
)";

class Record : public testing::Test {
 protected:
  void run(int steps) {
    for (int k = 0; k < steps; ++k) {
      simulation_.step();
      observe(simulation_, record_);
    }
    ASSERT_FALSE(simulation_.failed()) << simulation_.failure();
  }

  Simulation simulation_{parseScene(kScene, "hand.yaml")};
  RunRecord record_ = startRecord(simulation_);
};

TEST_F(Record, KnowsTheStart) {
  EXPECT_EQ(record_.piecesAtStart, 1);
  EXPECT_NEAR(record_.initialRestArea, 0.04, 1e-15);
  EXPECT_EQ(record_.initialMass, totalMass(simulation_.model()));
  EXPECT_FALSE(record_.separation);
}

TEST_F(Record, TheGreatestForceIsAtLeastTheWeight) {
  run(150);
  ASSERT_EQ(record_.peaks.size(), 1U);
  EXPECT_EQ(record_.peaks[0].clamp, "hand");
  // The cloth swings out under its weight, and pulls less than if all of it fell.
  const double weight = 9.81 * record_.initialMass;
  EXPECT_GE(record_.peaks[0].force, weight);
  EXPECT_LT(record_.peaks[0].force, 5.0 * weight);
  const PeakForce before = record_.peaks[0];
  run(10);  // the lower part falls: less to bear
  EXPECT_EQ(record_.peaks[0].force, before.force);
  EXPECT_EQ(record_.peaks[0].time, before.time);
}

TEST_F(Record, SaysWhenAndInWhatPhaseItCameApart) {
  run(149);
  EXPECT_FALSE(record_.separation);
  run(10);
  ASSERT_EQ(simulation_.pieces(), 2);
  ASSERT_TRUE(record_.separation);
  EXPECT_EQ(record_.separation->phase, "part");
  EXPECT_EQ(record_.separation->phaseStart, simulation_.script().history()[1].start);
  // The notch is made when the phase begins, and seen after the step that begins it.
  EXPECT_GE(record_.separation->time, record_.separation->phaseStart);
  EXPECT_LE(record_.separation->time, record_.separation->phaseStart + 1.5 * 0.01);
}

TEST_F(Record, AResetPutsItTogetherAgain) {
  run(160);
  ASSERT_TRUE(record_.separation);
  ASSERT_TRUE(simulation_.apply(Reset{}).success);
  run(1);
  EXPECT_FALSE(record_.separation);
}

TEST_F(Record, ARunThatBeginsInPiecesHasNotComeApartInIt) {
  run(160);
  RunRecord later = startRecord(simulation_);
  simulation_.step();
  observe(simulation_, later);
  EXPECT_FALSE(later.separation);
}

}  // namespace
}  // namespace cloth_sim
