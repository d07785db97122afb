/// \file The clock at the ends of ROS time.

#include <gtest/gtest.h>

#include <limits>

#include "ros/clock_publisher.h"

namespace cloth_sim {
namespace {

TEST(Clock, StandsStillWhereRosTimeEnds) {
  EXPECT_EQ(clockTime(12.5), ros::Time(12.5));
  EXPECT_EQ(clockTime(4294967296.0), ros::TIME_MAX);  // 2^32 s, where ros::Time throws
  EXPECT_EQ(clockTime(1e300), ros::TIME_MAX);
  EXPECT_EQ(clockTime(std::numeric_limits<double>::infinity()), ros::TIME_MAX);
  EXPECT_EQ(clockTime(0.0), ros::TIME_MIN);
  EXPECT_EQ(clockTime(-1.0), ros::TIME_MIN);
}

}  // namespace
}  // namespace cloth_sim
