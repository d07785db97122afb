/// \file What the border lets in, without a node and without a master.

#include "cloth_sim/ros/requests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "cloth_sim/scene/names.h"

namespace cloth_sim {
namespace {

using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class RequestsTest : public testing::Test {
 protected:
  RequestsTest() : checker_(scene(), toWorld) {
    pose_.header.frame_id = "world";
    pose_.pose.orientation.w = 1.0;
    stroke_.header.frame_id = "world";
    stroke_.points.resize(2);
    stroke_.points[1].x = 0.5;
    stroke_.direction.z = -1.0;
  }

  static Scene scene() {
    Scene scene;
    scene.clamps.resize(2);
    scene.clamps[0].name = "left";
    scene.clamps[1].name = "right";
    scene.phases.resize(1);
    scene.phases[0].name = "pull";
    return scene;
  }
  /// Knows "world" and "hand", which is 1 m above it.
  static Pose toWorld(const Pose& pose, const std_msgs::Header& header) {
    if (header.frame_id == "world") return pose;
    if (header.frame_id != "hand") throw std::runtime_error("unknown frame " + header.frame_id);
    return {pose.position + Vec3::UnitZ(), pose.orientation};
  }
  static std::string refusal(const Request& request) {
    const auto* refused = std::get_if<Refusal>(&request);
    return refused != nullptr ? refused->message : "";
  }

  RequestChecker checker_;
  geometry_msgs::PoseStamped pose_;
  CutStroke stroke_;
};

TEST_F(RequestsTest, GoodPoseBecomesACommandInTheWorldFrame) {
  pose_.header.frame_id = "hand";
  pose_.pose.position.x = 0.25;
  const Request request = checker_.clampPose("right", pose_);
  const auto& command = std::get<SetClampTarget>(std::get<Command>(request));
  EXPECT_EQ(command.clamp, "right");
  EXPECT_EQ(command.pose.position, Vec3(0.25, 0.0, 1.0));
}

TEST_F(RequestsTest, BadPosesAreRefused) {
  EXPECT_THAT(refusal(checker_.clampPose("lift", pose_)), HasSubstr("left, right"));
  geometry_msgs::PoseStamped bad = pose_;
  bad.pose.position.y = kNan;
  EXPECT_THAT(refusal(checker_.clampPose("left", bad)), HasSubstr("finite"));
  bad = pose_;
  bad.pose.orientation.z = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal(checker_.clampPose("left", bad)), HasSubstr("finite"));
  for (const double w : {0.0, 0.9, 1.1}) {
    bad = pose_;
    bad.pose.orientation.w = w;
    EXPECT_THAT(refusal(checker_.clampPose("left", bad)), HasSubstr("unit quaternion"));
  }
  bad = pose_;
  bad.header.frame_id = "nowhere";
  EXPECT_THAT(refusal(checker_.clampPose("left", bad)), HasSubstr("nowhere"));
}

TEST_F(RequestsTest, NearlyUnitQuaternionIsNormalised) {
  pose_.pose.orientation.w = 1.0 + 1e-5;  // what a float32 sender makes of a rotation
  const Request request = checker_.clampPose("left", pose_);
  const auto& command = std::get<SetClampTarget>(std::get<Command>(request));
  EXPECT_NEAR(command.pose.orientation.norm(), 1.0, 1e-15);
}

TEST_F(RequestsTest, UnknownNamesAreRefusedWithTheKnownOnes) {
  EXPECT_THAT(refusal(checker_.grasp("", true)), HasSubstr("left, right"));
  EXPECT_THAT(refusal(checker_.phase("push")), HasSubstr("pull"));
  EXPECT_EQ(refusal(checker_.phase("pull")), "");
  EXPECT_EQ(refusal(checker_.grasp("left", false)), "");
}

TEST_F(RequestsTest, StepsHaveARange) {
  EXPECT_NE(checker_.steps(0), "");
  EXPECT_EQ(checker_.steps(1), "");
  EXPECT_EQ(checker_.steps(1000000), "");
  EXPECT_NE(checker_.steps(1000001), "");
}

TEST_F(RequestsTest, StrokesAreChecked) {
  EXPECT_EQ(checker_.stroke(stroke_), "");
  CutStroke bad = stroke_;
  bad.points.clear();
  EXPECT_THAT(checker_.stroke(bad), HasSubstr("empty"));
  bad = stroke_;
  bad.points[1] = bad.points[0];
  EXPECT_THAT(checker_.stroke(bad), HasSubstr("two different"));
  bad = stroke_;
  bad.points[1].z = kNan;
  EXPECT_THAT(checker_.stroke(bad), HasSubstr("finite"));
  bad = stroke_;
  bad.direction.z = 0.0;
  EXPECT_THAT(checker_.stroke(bad), HasSubstr("zero"));
  bad = stroke_;
  bad.half_width = -1.0;
  EXPECT_THAT(checker_.stroke(bad), HasSubstr("half_width"));
  bad = stroke_;
  bad.header.frame_id = "nowhere";
  EXPECT_THAT(checker_.stroke(bad), HasSubstr("nowhere"));
}

TEST_F(RequestsTest, StateNamesAreNoPaths) {
  EXPECT_EQ(checker_.stateName("run_7.before-tear"), "");
  for (const char* bad : {"", "../up", "/etc/passwd", "a/b", ".hidden", "a b", "a\n"}) {
    EXPECT_NE(checker_.stateName(bad), "") << bad;
  }
  EXPECT_NE(checker_.stateName(std::string(101, 'a')), "");
}

TEST(Names, NearestIsTheOneWithTheFewestEdits) {
  const std::vector<std::string> known{"rate_markers", "rate_frame", "scene"};
  EXPECT_EQ(nearestName("rate_marker", known), "rate_markers");
  EXPECT_EQ(nearestName("scne", known), "scene");
  EXPECT_EQ(nearestName("zzzzzz", known), "");
}

}  // namespace
}  // namespace cloth_sim
