/// \file Requests from messages, without a node and without a master.

#include "ros/requests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "scene/names.h"

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
  /// Knows "world", "hand", which is 1 m above it, and "tilted", whose z points along its y.
  static Pose toWorld(const Pose& pose, const std_msgs::Header& header) {
    if (header.frame_id == "world") return pose;
    if (header.frame_id == "tilted") {
      const Quat turn(Eigen::AngleAxisd(-0.5 * M_PI, Vec3::UnitX()));
      return {turn * pose.position, turn * pose.orientation};
    }
    if (header.frame_id != "hand") throw std::runtime_error("unknown frame " + header.frame_id);
    return {pose.position + Vec3::UnitZ(), pose.orientation};
  }
  std::string errorAfter(const std::function<void(CutStroke&)>& spoil) const {
    CutStroke bad = stroke_;
    spoil(bad);
    return refusal(checker_.stroke(bad));
  }
  Stroke carriedOut(const CutStroke& stroke) const {
    return std::get<CutAlong>(std::get<Command>(checker_.stroke(stroke))).stroke;
  }
  Refine::Request refinement() const {
    Refine::Request request;
    request.header.frame_id = "world";
    request.points.resize(1);
    request.radius = 0.1;
    return request;
  }
  std::string errorAfter(const std::function<void(Refine::Request&)>& spoil) const {
    Refine::Request bad = refinement();
    spoil(bad);
    return refusal(checker_.refinement(bad));
  }
  /// Why a request is refused, by the border or by the command that it became.
  static std::string refusal(const Request& request) {
    const auto* refused = std::get_if<Refusal>(&request);
    return refused != nullptr ? refused->message : validationError(std::get<Command>(request));
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
  EXPECT_THAT(checker_.phaseError("push"), HasSubstr("pull"));
  EXPECT_EQ(checker_.phaseError("pull"), "");
}

TEST_F(RequestsTest, AGripperCommandIsAForceAndAWidth) {
  GripperCommand message;
  message.position = 0.01;
  EXPECT_EQ(checker_.gripper("left", message).size(), 1U) << "no effort: the force stays";
  message.max_effort = 12.0;
  const std::vector<Request> both = checker_.gripper("left", message);
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(std::get<SetGripForce>(std::get<Command>(both[0])).force, 12.0);
  EXPECT_EQ(std::get<SetGapWidth>(std::get<Command>(both[1])).width, 0.01);
  message.max_effort = -1.0;
  ASSERT_EQ(checker_.gripper("left", message).size(), 1U);
  EXPECT_THAT(refusal(checker_.gripper("left", message)[0]), HasSubstr("grip force"));
  message.max_effort = 12.0;
  message.position = kNan;
  ASSERT_EQ(checker_.gripper("left", message).size(), 1U) << "both or none";
  EXPECT_THAT(refusal(checker_.gripper("left", message)[0]), HasSubstr("width"));
}

TEST_F(RequestsTest, AMoveIsAWayInTheWorldFrame) {
  MoveClampGoal goal;
  goal.poses = {pose_, pose_};
  goal.poses[1].header.frame_id = "hand";
  goal.times_from_start = {ros::Duration(1.0), ros::Duration(2.5)};
  goal.position_tolerance = 0.02;
  const MovePlan plan = std::get<MovePlan>(checker_.move(goal));
  EXPECT_TRUE(plan.timed);
  EXPECT_EQ(plan.waypoints[1].time, 2.5);
  EXPECT_EQ(plan.waypoints[1].pose.position.z(), 1.0);
  EXPECT_EQ(plan.positionTolerance, 0.02);
  EXPECT_EQ(plan.orientationTolerance, MovePlan().orientationTolerance);
  EXPECT_FALSE(plan.timeLimit);

  const auto refusal = [&] { return std::get<Refusal>(checker_.move(goal)).message; };
  goal.times_from_start.pop_back();
  EXPECT_THAT(refusal(), HasSubstr("as many as poses (got 1 and 2)"));
  goal.times_from_start.clear();
  goal.poses[1].pose.position.x = kNan;
  EXPECT_THAT(refusal(), HasSubstr("poses[1]: position"));
  goal.poses[1] = pose_;
  goal.poses[0].header.frame_id = "nowhere";
  EXPECT_THAT(refusal(), HasSubstr("poses[0]: unknown frame nowhere"));
  goal.poses.clear();
  EXPECT_THAT(refusal(), HasSubstr("poses"));
  goal.poses.assign(10001, pose_);
  EXPECT_THAT(refusal(), HasSubstr("at most 10000"));
}

TEST_F(RequestsTest, ATrajectoryIsThatOfOneBody) {
  trajectory_msgs::MultiDOFJointTrajectory message;
  message.header.frame_id = "hand";
  message.joint_names = {"any"};
  message.points.resize(1);
  message.points[0].transforms.resize(1);
  message.points[0].transforms[0].rotation.w = 1.0;
  message.points[0].time_from_start = ros::Duration(2.0);
  const MovePlan plan = std::get<MovePlan>(checker_.trajectory(message));
  EXPECT_TRUE(plan.timed);
  EXPECT_EQ(plan.waypoints[0].time, 2.0);
  EXPECT_EQ(plan.waypoints[0].pose.position.z(), 1.0);
  const auto refusal = [&] { return std::get<Refusal>(checker_.trajectory(message)).message; };
  message.points[0].transforms.resize(2);
  EXPECT_THAT(refusal(), HasSubstr("points[0].transforms: expected one (got 2)"));
  message.joint_names.emplace_back("more");
  EXPECT_THAT(refusal(), HasSubstr("joint_names"));
}

TEST_F(RequestsTest, ANewClampTakesDefaultsWhereNumbersAreZero) {
  AddClamp::Request message;
  message.name = "third";
  message.pose = pose_;
  message.plate_size[1] = 0.5;
  message.grip_force = 3.0;
  const Request request = checker_.newClamp(message);
  const ClampSpec& spec = std::get<CreateClamp>(std::get<Command>(request)).spec;
  const ClampSpec usual;
  EXPECT_EQ(spec.name, "third");
  EXPECT_EQ(spec.plateSize, Vec2(usual.plateSize.x(), 0.5));
  EXPECT_EQ(spec.gapOpen, usual.gapOpen);
  EXPECT_EQ(spec.gripForce, 3.0);
  message.name = "all";
  EXPECT_THAT(refusal(checker_.newClamp(message)), HasSubstr("name"));
  message.name = "third";
  message.pose.pose.orientation.w = 2.0;
  EXPECT_THAT(refusal(checker_.newClamp(message)), HasSubstr("unit quaternion"));
}

TEST_F(RequestsTest, StepsHaveARange) {
  EXPECT_NE(stepCountError(0), "");
  EXPECT_EQ(stepCountError(1), "");
  EXPECT_EQ(stepCountError(1000000), "");
  EXPECT_NE(stepCountError(1000001), "");
}

TEST_F(RequestsTest, StrokeAlongAPathReachesToBothSides) {
  const Stroke stroke = carriedOut(stroke_);
  ASSERT_EQ(stroke.poses.size(), 2u);
  EXPECT_TRUE(stroke.poses[0].heel.isApprox(Vec3(0.0, 0.0, 1.0), 1e-12));  // against -z, by 1 m
  EXPECT_TRUE(stroke.poses[1].tip.isApprox(Vec3(0.5, 0.0, -1.0), 1e-12));
  EXPECT_FALSE(stroke.firstLayerOnly);
  EXPECT_EQ(stroke.halfWidth, 0.0);
}

TEST_F(RequestsTest, StrokeIsTakenAsItIsGiven) {
  stroke_.direction.z = -5.0;  // any length
  stroke_.reach = 0.25;
  stroke_.half_width = 0.01;
  stroke_.first_layer_only = true;
  const Stroke stroke = carriedOut(stroke_);
  EXPECT_TRUE(stroke.poses[1].tip.isApprox(Vec3(0.5, 0.0, -0.25), 1e-12));
  EXPECT_TRUE(stroke.firstLayerOnly);
  EXPECT_EQ(stroke.halfWidth, 0.01);
}

TEST_F(RequestsTest, HeelsTakeThePlaceOfDirectionAndReach) {
  stroke_.heels = stroke_.points;
  for (geometry_msgs::Point& heel : stroke_.heels) heel.y = 0.5;
  stroke_.direction.z = 0.0;
  stroke_.reach = kNan;
  const Stroke stroke = carriedOut(stroke_);
  ASSERT_EQ(stroke.poses.size(), 2u);
  EXPECT_EQ(stroke.poses[1].heel, Vec3(0.5, 0.5, 0.0));
  EXPECT_EQ(stroke.poses[1].tip, Vec3(0.5, 0.0, 0.0));
}

TEST_F(RequestsTest, StrokesAreTurnedIntoTheWorldFrame) {
  stroke_.header.frame_id = "hand";
  EXPECT_TRUE(carriedOut(stroke_).poses[1].tip.isApprox(Vec3(0.5, 0.0, 0.0), 1e-12));
  stroke_.header.frame_id = "tilted";  // the direction, -z there, is -y in the world
  EXPECT_TRUE(carriedOut(stroke_).poses[1].tip.isApprox(Vec3(0.5, -1.0, 0.0), 1e-12));
  stroke_.heels = stroke_.points;
  for (geometry_msgs::Point& heel : stroke_.heels) heel.z = 0.5;
  EXPECT_TRUE(carriedOut(stroke_).poses[1].heel.isApprox(Vec3(0.5, 0.5, 0.0), 1e-12));
}

TEST_F(RequestsTest, BadStrokesAreRefused) {
  EXPECT_THAT(errorAfter([](CutStroke& s) { s.points.clear(); }), HasSubstr("two poses"));
  EXPECT_THAT(errorAfter([](CutStroke& s) { s.points.resize(1); }), HasSubstr("two poses"));
  EXPECT_THAT(errorAfter([](CutStroke& s) { s.points.resize(10001); }), HasSubstr("10000"));
  EXPECT_NE(errorAfter([](CutStroke& s) { s.points[1] = s.points[0]; }), "");
  EXPECT_THAT(errorAfter([](CutStroke& s) { s.points[1].z = kNan; }), HasSubstr("finite"));
  EXPECT_THAT(errorAfter([](CutStroke& s) { s.direction.x = kNan; }), HasSubstr("finite"));
  EXPECT_THAT(errorAfter([](CutStroke& s) { s.direction.z = 0.0; }), HasSubstr("zero"));
  EXPECT_THAT(errorAfter([](CutStroke& s) { s.reach = -1.0; }), HasSubstr("reach"));
  EXPECT_THAT(errorAfter([](CutStroke& s) { s.half_width = -1.0; }), HasSubstr("half-width"));
  EXPECT_THAT(errorAfter([](CutStroke& s) { s.half_width = kNan; }), HasSubstr("half-width"));
  EXPECT_THAT(errorAfter([](CutStroke& s) { s.header.frame_id = "nowhere"; }),
              HasSubstr("nowhere"));
  EXPECT_THAT(errorAfter([](CutStroke& s) { s.heels.resize(1); }), HasSubstr("1 and 2"));
  EXPECT_THAT(errorAfter([](CutStroke& s) {
                s.heels.resize(2);
                s.heels[0].x = kNan;
              }),
              HasSubstr("finite"));
  EXPECT_NE(errorAfter([](CutStroke& s) { s.heels = s.points; }), "");  // blades of no length
}

TEST_F(RequestsTest, RefinementBecomesACommandInTheWorldFrame) {
  Refine::Request request = refinement();
  request.header.frame_id = "hand";
  const Request made = checker_.refinement(request);
  const auto& command = std::get<RefineMesh>(std::get<Command>(made)).request;
  EXPECT_EQ(command.path, std::vector<Vec3>{Vec3(0.0, 0.0, 1.0)});
  EXPECT_EQ(command.refinement.radius, 0.1);
  EXPECT_EQ(command.refinement.generations, 3);
  EXPECT_EQ(command.refinement.minEdge, 0.0);

  request.generations = 12;
  request.min_edge = 0.01;
  const Request finer = checker_.refinement(request);
  EXPECT_EQ(std::get<RefineMesh>(std::get<Command>(finer)).request.refinement.generations, 12);
  EXPECT_EQ(std::get<RefineMesh>(std::get<Command>(finer)).request.refinement.minEdge, 0.01);
}

TEST_F(RequestsTest, BadRefinementsAreRefused) {
  EXPECT_THAT(errorAfter([](Refine::Request& r) { r.points.clear(); }), HasSubstr("empty"));
  EXPECT_THAT(errorAfter([](Refine::Request& r) { r.points[0].y = kNan; }), HasSubstr("finite"));
  EXPECT_THAT(errorAfter([](Refine::Request& r) { r.radius = 0.0; }), HasSubstr("radius"));
  EXPECT_THAT(errorAfter([](Refine::Request& r) { r.radius = kNan; }), HasSubstr("radius"));
  EXPECT_THAT(errorAfter([](Refine::Request& r) { r.generations = 13; }), HasSubstr("generations"));
  EXPECT_THAT(errorAfter([](Refine::Request& r) { r.min_edge = -1.0; }), HasSubstr("min_edge"));
  EXPECT_THAT(errorAfter([](Refine::Request& r) { r.header.frame_id = ""; }), HasSubstr("frame"));
}

TEST_F(RequestsTest, StateNamesAreNoPaths) {
  EXPECT_EQ(stateNameError("run_7.before-tear"), "");
  for (const char* bad : {"", "../up", "/etc/passwd", "a/b", ".hidden", "a b", "a\n"}) {
    EXPECT_NE(stateNameError(bad), "") << bad;
  }
  EXPECT_NE(stateNameError(std::string(101, 'a')), "");
}

TEST(Names, NearestIsTheOneWithTheFewestEdits) {
  const std::vector<std::string> known{"rate_markers", "rate_frame", "scene"};
  EXPECT_EQ(nearestName("rate_marker", known), "rate_markers");
  EXPECT_EQ(nearestName("scne", known), "scene");
  EXPECT_EQ(nearestName("zzzzzz", known), "");
}

}  // namespace
}  // namespace cloth_sim
