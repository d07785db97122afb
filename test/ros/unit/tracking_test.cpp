/// \file Sequences of poses as targets that move, and the low-pass over wrenches.

#include <gtest/gtest.h>

#include "ros/motion_estimator.h"
#include "ros/pose_source.h"
#include "ros/wrench_filter.h"

namespace cloth_sim {
namespace {

Pose at(double x, double yaw = 0.0) {
  return {Vec3(x, 0.0, 0.0), Quat(Eigen::AngleAxisd(yaw, Vec3::UnitZ()))};
}

TEST(MotionEstimator, GivesTheVelocityOfTheWay) {
  MotionEstimator tracker;
  ASSERT_TRUE(tracker.add(10.0, at(0.0)));
  const std::optional<MovingPose> target = tracker.add(10.02, at(0.01, 0.004));
  ASSERT_TRUE(target);
  EXPECT_NEAR(target->linear.x(), 0.5, 1e-9);
  EXPECT_NEAR(target->angular.z(), 0.2, 1e-9);
  EXPECT_NEAR(target->horizon, 0.04, 1e-9);
}

TEST(MotionEstimator, TurnsTheShortWay) {
  MotionEstimator tracker;
  tracker.add(1.0, at(0.0, 0.01));
  Pose turned = at(0.0, -0.01);
  turned.orientation.coeffs() *= -1.0;  // the same orientation
  EXPECT_NEAR(tracker.add(1.05, turned)->angular.z(), -0.4, 1e-9);
}

TEST(MotionEstimator, SinglePosesStandStill) {
  MotionEstimator tracker;
  EXPECT_EQ(tracker.add(1.0, at(0.0))->horizon, 0.0);
  EXPECT_EQ(tracker.add(2.0, at(1.0))->linear, Vec3::Zero()) << "too long ago";
  EXPECT_EQ(tracker.add(1.5, at(0.5))->linear, Vec3::Zero()) << "time went back";
  EXPECT_NE(tracker.add(1.52, at(0.6))->linear, Vec3::Zero());
}

TEST(MotionEstimator, SaysNothingOfWhatIsOld) {
  MotionEstimator tracker;
  ASSERT_TRUE(tracker.add(1.0, at(0.0)));
  EXPECT_FALSE(tracker.add(1.0, at(0.0)));
  MotionEstimator fixed;
  ASSERT_TRUE(fixed.add(0.0, at(0.0)));
  EXPECT_FALSE(fixed.add(0.0, at(0.0)));
  EXPECT_TRUE(fixed.add(0.0, at(1.0))) << "a fixed frame that was put elsewhere";
}

TEST(PoseSource, IsNotSilentWhileTimeStandsStill) {
  EXPECT_EQ(silence(0.4, 0.4), 0.4);
  EXPECT_EQ(silence(5.0, 0.1), 0.1) << "the simulation is slow, or paused";
  EXPECT_EQ(silence(0.3, 2.0), 0.3) << "the simulation is fast";
  EXPECT_EQ(silence(0.3, -7.0), 0.3) << "time has jumped back";
}

/// The step response of a first-order low-pass after one time constant is 1 - 1/e.
TEST(WrenchFilter, IsAFirstOrderLowPass) {
  const double cutoff = 2.0;
  const double constant = 1.0 / (2.0 * M_PI * cutoff);
  WrenchFilter filter(cutoff);
  filter.filter(0.0, Wrench());
  Wrench one;
  one.force.x() = 1.0;
  one.torque.y() = 2.0;
  Wrench out;
  for (int k = 1; k <= 10; ++k) out = filter.filter(0.1 * k * constant, one);
  EXPECT_NEAR(out.force.x(), 1.0 - std::exp(-1.0), 1e-12);
  EXPECT_NEAR(out.torque.y(), 2.0 * (1.0 - std::exp(-1.0)), 1e-12);
  EXPECT_EQ(filter.filter(0.0, one).force.x(), 1.0) << "time went back: it begins anew";
}

TEST(WrenchFilter, IsOffAtZero) {
  WrenchFilter filter(0.0);
  Wrench one;
  one.force.x() = 1.0;
  filter.filter(0.0, Wrench());
  EXPECT_EQ(filter.filter(1e-6, one).force.x(), 1.0);
}

TEST(PoseSource, TakesOneSource) {
  Follow::Request request;
  EXPECT_EQ(sourceError(request), "");
  EXPECT_EQ(toString(toPoseSource(request)), "nothing");
  request.tf = "gripper_link";
  EXPECT_EQ(sourceError(request), "");
  EXPECT_EQ(toString(toPoseSource(request)), "tf frame gripper_link");
  request.pose = "/arm/pose";
  EXPECT_NE(sourceError(request), "");
  request.tf.clear();
  EXPECT_EQ(toString(toPoseSource(request)), "topic /arm/pose");
  request.grasp_width = "not a topic";
  EXPECT_NE(sourceError(request).find("grasp_width"), std::string::npos);
}

}  // namespace
}  // namespace cloth_sim
