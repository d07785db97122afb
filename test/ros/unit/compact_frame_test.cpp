/// \file Positions -> 16-bit increments -> positions.

#include "ros/compact_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"

namespace cloth_sim {
namespace {

constexpr double kHalfUnit = 0.5e-4;  // [m]

Snapshot snapshotOf(const std::vector<Vec3>& positions) {
  Snapshot snapshot;
  auto topology = std::make_shared<Topology>();
  topology->revision = 7;
  snapshot.topology = topology;
  snapshot.step = 12;
  snapshot.time = 0.2;
  snapshot.positions = positions;
  return snapshot;
}

/// The largest distance along an axis between positions and those of the expanded frame [m].
double errorOf(const std::vector<Vec3>& positions, const ClothFrame& frame) {
  double largest = 0.0;
  for (std::size_t k = 0; k < frame.positions.size(); ++k) {
    largest = std::max(largest, std::abs(positions[k / 3][k % 3] - frame.positions[k]));
  }
  return largest;
}

TEST(CompactFrame, PositionsAreWithinHalfAUnitHoweverManyThereAre) {
  std::vector<Vec3> positions;
  for (int k = 0; k < 20000; ++k) {
    positions.emplace_back(0.3 + 1e-5 * k, std::sin(0.1 * k), -1.0 + 0.7 * std::cos(0.37 * k));
  }
  CompactFrame compact;
  fillCompactFrame(snapshotOf(positions), {}, compact);
  EXPECT_EQ(compact.unit, 1e-4);
  ClothFrame frame;
  ASSERT_EQ(expandFrame(compact, frame), "");
  ASSERT_EQ(frame.positions.size(), 3 * positions.size());
  EXPECT_LT(errorOf(positions, frame), kHalfUnit + 2e-7);  // and float32
  EXPECT_EQ(frame.revision, 7u);
  EXPECT_EQ(frame.step, 12u);
  EXPECT_EQ(frame.time, 0.2);
}

TEST(CompactFrame, UnitGrowsWhereParticlesAreTooFarApart) {
  const std::vector<Vec3> positions{{0.0, 0.0, 0.0}, {100.0, -200.0, 1.0}, {0.0, 0.5, 0.0}};
  CompactFrame compact;
  fillCompactFrame(snapshotOf(positions), {}, compact);
  EXPECT_NEAR(compact.unit, 200.5 / 32766.0, 1e-9);
  ClothFrame frame;
  ASSERT_EQ(expandFrame(compact, frame), "");
  EXPECT_LT(errorOf(positions, frame), 0.5 * compact.unit + 1e-5);
}

TEST(CompactFrame, EmptyAndWrongOnes) {
  CompactFrame compact;
  fillCompactFrame(snapshotOf({}), {}, compact);
  ClothFrame frame;
  EXPECT_EQ(expandFrame(compact, frame), "");
  EXPECT_TRUE(frame.positions.empty());
  compact.increments = {1, 2};
  EXPECT_NE(expandFrame(compact, frame), "");
  compact.increments = {0, 0, 0};
  for (const double unit : {0.0, -1e-4, std::numeric_limits<double>::quiet_NaN()}) {
    compact.unit = unit;
    EXPECT_NE(expandFrame(compact, frame), "") << unit;
  }
}

}  // namespace
}  // namespace cloth_sim
