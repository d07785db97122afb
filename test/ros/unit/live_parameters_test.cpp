/// \file Configurations <-> commands, without a node and without a master.

#include "ros/live_parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace cloth_sim {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

Tuning usual() {
  Tuning tuning;
  tuning.gravity = Vec3(0.0, 0.0, -9.81);
  tuning.tearing = true;
  tuning.ratio = {1.5, 2.0, kNever};
  return tuning;
}

template <typename Wanted>
const Wanted* only(const std::vector<Command>& commands) {
  return commands.size() == 1 ? std::get_if<Wanted>(&commands[0]) : nullptr;
}

TEST(LiveParameters, ShowTheSimulationAsItIs) {
  Tuning tuning = usual();
  tuning.wind = Wind{Vec3(1.0, 2.0, 3.0), 1.2, 1.0};
  tuning.stiffness = 4.0;
  const ClothConfig config = toConfig(tuning);
  EXPECT_EQ(config.gravity, 9.81);
  EXPECT_EQ(config.wind_x, 1.0);
  EXPECT_EQ(config.wind_y, 2.0);
  EXPECT_EQ(config.wind_z, 3.0);
  EXPECT_TRUE(config.tearing);
  EXPECT_EQ(config.tear_strain, 0.5) << "the weakest kind";
  EXPECT_EQ(config.stiffness, 4.0);
  tuning.ratio.fill(kNever);
  EXPECT_EQ(toConfig(tuning).tear_strain, ClothConfig::__getMax__().tear_strain);
}

TEST(LiveParameters, WhatDoesNotChangeIsNotCommanded) {
  const ClothConfig config = toConfig(usual());
  EXPECT_TRUE(commandsBetween(config, config, usual(), SceneTuning()).empty());
}

TEST(LiveParameters, GravityKeepsTheDirectionOfTheScene) {
  Scene scene;
  scene.gravity = Vec3(0.0, -3.0, -4.0);
  const ClothConfig before = toConfig(usual());
  ClothConfig after = before;
  after.gravity = 10.0;
  const auto commands = commandsBetween(before, after, usual(), sceneTuning(scene));
  ASSERT_NE(only<SetGravity>(commands), nullptr);
  EXPECT_NEAR((only<SetGravity>(commands)->gravity - Vec3(0.0, -6.0, -8.0)).norm(), 0.0, 1e-12);
  scene.gravity = Vec3::Zero();
  const auto weightless = commandsBetween(before, after, usual(), sceneTuning(scene));
  EXPECT_EQ(only<SetGravity>(weightless)->gravity, Vec3(0.0, 0.0, -10.0));
}

TEST(LiveParameters, NoWindIsNoAirWhereTheSceneHasNone) {
  const ClothConfig still = toConfig(usual());
  ClothConfig windy = still;
  windy.wind_y = 5.0;
  const auto on = commandsBetween(still, windy, usual(), SceneTuning());
  ASSERT_NE(only<SetWind>(on), nullptr);
  ASSERT_TRUE(only<SetWind>(on)->wind);
  EXPECT_EQ(only<SetWind>(on)->wind->velocity, Vec3(0.0, 5.0, 0.0));
  const auto off = commandsBetween(windy, still, usual(), SceneTuning());
  ASSERT_NE(only<SetWind>(off), nullptr);
  EXPECT_FALSE(only<SetWind>(off)->wind);
  SceneTuning scene;
  scene.wind = Wind{Vec3(1.0, 0.0, 0.0), 0.9, 1.3};
  const auto calm = commandsBetween(windy, still, usual(), scene);
  ASSERT_TRUE(only<SetWind>(calm)->wind) << "its air stays";
  EXPECT_EQ(only<SetWind>(calm)->wind->density, 0.9);
}

TEST(LiveParameters, TearLimitsKeepTheirProportion) {
  EXPECT_THAT(scaledRatios({1.5, 2.0, kNever}, 0.25), testing::ElementsAre(1.25, 1.5, kNever));
  EXPECT_THAT(scaledRatios({kNever, kNever, kNever}, 0.25),
              testing::ElementsAre(1.25, 1.25, kNever));
}

TEST(LiveParameters, TearingIsSwitchedWithoutChangingItsLimits) {
  const ClothConfig before = toConfig(usual());
  ClothConfig after = before;
  after.tearing = false;
  const auto commands = commandsBetween(before, after, usual(), SceneTuning());
  ASSERT_NE(only<SetTearing>(commands), nullptr);
  EXPECT_FALSE(only<SetTearing>(commands)->enabled);
  EXPECT_EQ(only<SetTearing>(commands)->ratio, usual().ratio);
}

TEST(LiveParameters, QuasiStaticMotionIsDeclaredAlone) {
  const ClothConfig before = toConfig(usual());
  ClothConfig after = before;
  after.quasi_static = true;
  const auto commands = commandsBetween(before, after, usual(), SceneTuning());
  ASSERT_EQ(commands.size(), 1U);
  ASSERT_NE(only<SetQuasiStatic>(commands), nullptr);
  EXPECT_TRUE(only<SetQuasiStatic>(commands)->enabled);
}

}  // namespace
}  // namespace cloth_sim
