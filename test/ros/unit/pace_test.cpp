/// \file Tests of Pace, which limits how often something happens.

#include "ros/pace.h"

#include <gtest/gtest.h>

#include <random>

namespace cloth_sim {
namespace {

using std::chrono::milliseconds;

constexpr double kRate = 100.0;  ///< [Hz]: a period of 10 ms

/// Returns how many of these times [ms] are let through.
template <typename Times>
int taken(const Times& times) {
  const Pace::Clock::time_point start = Pace::Clock::now();
  Pace pace;
  int count = 0;
  for (const int time : times) {
    if (!pace.isDue(start + milliseconds(time), kRate)) continue;
    pace.take(start + milliseconds(time), kRate);
    ++count;
  }
  return count;
}

TEST(Pace, LetsThroughWhatComesAtItsRateWithJitter) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> late(0, 2);
  std::vector<int> times;
  for (int k = 0; k < 1000; ++k) times.push_back(10 * k + late(random));
  EXPECT_EQ(taken(times), 1000);
}

TEST(Pace, HoldsItsRateAgainstWhatComesMoreOften) {
  std::vector<int> times;
  for (int k = 0; k < 10000; ++k) times.push_back(k);
  EXPECT_NEAR(taken(times), 1000, 2);
}

TEST(Pace, IsNotMadeUpForAfterASilence) {
  EXPECT_EQ(taken(std::vector<int>{0, 1000, 1001, 1002, 1003, 1004}), 2);
}

TEST(Pace, FollowsAChangeOfRateAtOnce) {
  const Pace::Clock::time_point start = Pace::Clock::now();
  Pace pace;
  pace.take(start, 1.0);
  EXPECT_FALSE(pace.isDue(start + milliseconds(20), 1.0));
  EXPECT_TRUE(pace.isDue(start + milliseconds(20), kRate));
}

}  // namespace
}  // namespace cloth_sim
