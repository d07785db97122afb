/// \file Robots: collision geometry from a URDF, obstacles of a scene, clamps between fingers.

#include "ros/robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth_sim/scene/load.h"

namespace cloth_sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// An arm with one link of each kind of geometry, and a gripper of two fingers that close along z.
const char* const kArm = R"(<robot name="arm">
  <link name="base"/>
  <link name="upper-arm">
    <collision><origin xyz="0 0 0.1" rpy="0 1.5707963267948966 0"/>
      <geometry><cylinder radius="0.02" length="0.2"/></geometry></collision>
    <collision><geometry><sphere radius="0.03"/></geometry></collision>
  </link>
  <link name="palm"><collision><geometry><box size="0.02 0.1 0.04"/></geometry></collision></link>
  <link name="lower"><collision><origin xyz="0.05 0 0"/>
    <geometry><box size="0.04 0.1 0.004"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0.05 0 0"/>
    <geometry><box size="0.04 0.1 0.008"/></geometry></collision></link>
  <joint name="shoulder" type="fixed"><parent link="base"/><child link="upper-arm"/></joint>
  <joint name="wrist" type="fixed"><parent link="upper-arm"/><child link="palm"/></joint>
  <joint name="lower_joint" type="fixed"><parent link="palm"/><child link="lower"/></joint>
  <joint name="upper_joint" type="prismatic"><parent link="palm"/><child link="upper"/>
    <axis xyz="0 0 2"/><limit lower="0" upper="0.1" effort="1" velocity="1"/></joint>
</robot>)";

const char* const kScene = "cloth: {size: [0.2, 0.2], particles: [5, 5]}\n";

std::string asGiven(const std::string& url) { return url; }

/// A robot of one link.
std::string linkWith(const std::string& geometry) {
  return "<robot name='r'><link name='palm'><collision><geometry>" + geometry +
         "</geometry></collision></link></robot>";
}

std::vector<std::string> obstacleNames(const Robot& robot) {
  std::vector<std::string> names;
  for (const RobotObstacle& it : robot.obstacles) names.push_back(it.name);
  return names;
}

Robot robotOf(const std::string& urdf, const RobotSettings& settings) {
  return chooseLinks(RobotDescription(urdf), settings, asGiven);
}

/// The error of a robot; "" if there is none.
std::string errorOf(const std::string& urdf, const RobotSettings& settings = {}) {
  try {
    robotOf(urdf, settings);
    return "";
  } catch (const RobotError& error) {
    return error.what();
  }
}

void expectNear(const Vec3& a, const Vec3& b) { EXPECT_LT((a - b).norm(), 1e-12) << a.transpose(); }

TEST(Robot, MakesObstaclesOfItsLinks) {
  const Robot robot = robotOf(kArm, {});
  EXPECT_THAT(obstacleNames(robot),
              ElementsAre("lower", "palm", "upper", "upper_arm", "upper_arm_2"));
}

TEST(Robot, ItsObstaclesArePartOfTheScene) {
  const Robot robot = robotOf(kArm, {});
  const Scene scene = parseScene(kScene, "scene.yaml", overridesOf(robot.obstacles));
  ASSERT_EQ(scene.obstacles.size(), 5U);
  for (const Obstacle& it : scene.obstacles) EXPECT_EQ(it.pose.position.z(), -1000.0) << it.name;
  const auto& cylinder = std::get<CylinderShape>(scene.obstacles[3].shape);
  EXPECT_EQ(cylinder.radius, 0.02);
  EXPECT_EQ(cylinder.length, 0.2);
  EXPECT_EQ(std::get<BoxShape>(scene.obstacles[1].shape).size, Vec3(0.02, 0.1, 0.04));
  EXPECT_EQ(std::get<SphereShape>(scene.obstacles[4].shape).radius, 0.03);
  const Scene again = parseScene(scene.text, "scene.yaml");
  EXPECT_EQ(again.obstacles.size(), 5U) << "a bag holds this text";
}

TEST(Robot, OverridesOfUsersChangeItsObstacles) {
  std::vector<std::string> overrides = overridesOf(robotOf(kArm, {}).obstacles);
  overrides.emplace_back("obstacles.palm.friction=0.2");
  const Scene scene = parseScene(kScene, "scene.yaml", overrides);
  ASSERT_EQ(scene.obstacles[1].name, "palm");
  EXPECT_EQ(scene.obstacles[1].friction, 0.2);
}

TEST(Robot, TheOriginOfAnElementIsItsPlace) {
  const Pose place = robotOf(kArm, {}).obstacles[3].part.place;
  expectNear(place.position, Vec3(0.0, 0.0, 0.1));
  expectNear(place.orientation * Vec3::UnitZ(), Vec3::UnitX());
}

TEST(Robot, PlatesAndFilteredLinksAreNoObstacles) {
  RobotSettings settings;
  settings.clamps["hand"].plates = {"lower", "upper"};
  settings.selfFilter = {"upper-arm"};
  EXPECT_THAT(obstacleNames(robotOf(kArm, settings)), ElementsAre("palm"));
  settings.links = {"upper", "palm", "upper-arm", "palm"};
  EXPECT_THAT(obstacleNames(robotOf(kArm, settings)), ElementsAre("upper", "palm"));
}

TEST(Robot, ReadsMeshes) {
  const std::string flap = CLOTH_SIM_SOURCE_DIR "/config/scenes/flap.obj";
  const std::string urdf = linkWith("<mesh filename='" + flap + "' scale='0.5 0.5 0.5'/>");
  const Robot robot = robotOf(urdf, {});
  const Scene scene = parseScene(kScene, "scene.yaml", overridesOf(robot.obstacles));
  const auto& mesh = std::get<MeshShape>(scene.obstacles.at(0).shape);
  EXPECT_EQ(mesh.file.path, flap);
  const LinkBox box = boxAround({robot.obstacles[0].part});
  expectNear(box.centre, 0.5 * (mesh.file.surface->low() + mesh.file.surface->high()));
  expectNear(2.0 * box.half, mesh.file.surface->high() - mesh.file.surface->low());
}

TEST(Robot, AMeshMayBeMirroredAndScaledByAxis) {
  const std::string flap = CLOTH_SIM_SOURCE_DIR "/config/scenes/flap.obj";
  const auto surfaceOf = [&flap](const std::string& scale) {
    const Robot robot = robotOf(linkWith("<mesh filename='" + flap + "' " + scale + "/>"), {});
    const Scene scene = parseScene(kScene, "scene.yaml", overridesOf(robot.obstacles));
    return std::get<MeshShape>(scene.obstacles.at(0).shape).file.surface;
  };
  const auto plain = surfaceOf("");
  const auto scaled = surfaceOf("scale='2 -1 0.5'");
  expectNear(scaled->high(),
             Vec3(2.0 * plain->high().x(), -plain->low().y(), 0.5 * plain->high().z()));
  expectNear(scaled->low(),
             Vec3(2.0 * plain->low().x(), -plain->high().y(), 0.5 * plain->low().z()));
}

TEST(Robot, RefusesABadDescriptionInOneLine) {
  EXPECT_EQ(errorOf("arm.urdf"), "the URDF is malformed: Error document empty");
  EXPECT_EQ(errorOf("<robot name='r'><link name='a'></robot>"),
            "the URDF is malformed: Error reading end tag");
  EXPECT_THAT(errorOf(linkWith("<box size='1 a 2'/>")), HasSubstr("malformed"));
  EXPECT_EQ(errorOf("<robot name='r'><link name='a'/></robot>"),
            "the URDF has no collision geometry");
  EXPECT_EQ(errorOf(linkWith("<sphere radius='-1'/>")),
            "link 'palm': radius: expected a length > 0");
  EXPECT_NE(errorOf("<robot name='r'><link name='palm'><collision><origin xyz='nan 0 0'/>"
                    "<geometry><sphere radius='1'/></geometry></collision></link></robot>"),
            "")
      << "by the parser, or because of the place where the parser takes it";
  EXPECT_EQ(errorOf(linkWith("<mesh filename='/no/palm.stl'/>")),
            "link 'palm': /no/palm.stl: cannot be read (No such file or directory)");
  EXPECT_THAT(errorOf(linkWith("<mesh filename='/no/palm.dae'/>")), HasSubstr("cannot be read"));
  EXPECT_THAT(errorOf(linkWith("<mesh filename='/no/palm.ply'/>")), HasSubstr(".obj or .dae"));
  EXPECT_THAT(errorOf(linkWith("<mesh filename='/no/palm.stl' scale='1 0 2'/>")),
              HasSubstr("a scale other than 0"));
}

TEST(Robot, RefusesBadLinks) {
  RobotSettings settings;
  settings.links = {"plam"};
  EXPECT_EQ(errorOf(kArm, settings),
            "unknown link 'plam' (known: base, lower, palm, upper, upper-arm)");
  settings.links = {"base"};
  EXPECT_EQ(errorOf(kArm, settings), "link 'base' has no collision geometry");
  settings = {};
  settings.selfFilter = {"hand"};
  EXPECT_THAT(errorOf(kArm, settings), HasSubstr("unknown link 'hand'"));
  settings = {};
  settings.clamps["hand"].plates = {"lower", "lower"};
  EXPECT_EQ(errorOf(kArm, settings), "clamp 'hand': expected two links as plates");
}

TEST(Robot, ListsTenLinksAtMost) {
  std::string urdf = "<robot name='r'><link name='root'/>";
  for (char c = 'a'; c < 'a' + 20; ++c) {
    const std::string name(1, c);
    urdf += "<link name='" + name + "'/><joint name='to_" + name +
            "' type='fixed'><parent link='root'/><child link='" + name + "'/></joint>";
  }
  RobotSettings settings;
  settings.links = {"elbow"};
  EXPECT_THAT(errorOf(urdf + "</robot>", settings), HasSubstr("i, j and 11 more"));
}

TEST(Robot, RefusesNamesOfTheSceneAndUnknownClamps) {
  RobotSettings settings;
  settings.clamps["hand"].plates = {"lower", "upper"};
  const Robot robot = robotOf(kArm, settings);
  EXPECT_NO_THROW(checkNames(robot, {"table"}, {"hand"}));
  EXPECT_THROW(checkNames(robot, {"palm"}, {"hand"}), RobotError);
  EXPECT_THROW(checkNames(robot, {"table"}, {"left"}), RobotError);
}

// ---- motors of grippers -----------------------------------------------------------------------

TEST(GripMotor, MovesOnePlate) {
  RobotSettings settings;
  settings.clamps["hand"] = {{"lower", "upper"}, "upper_joint", 0.4};
  const auto motor = robotOf(kArm, settings).grippers.at(0).motor;
  ASSERT_TRUE(motor);
  EXPECT_EQ(motor->name, "upper_joint");
  EXPECT_EQ(motor->plate, 1U);
  EXPECT_EQ(motor->friction, 0.4);
  EXPECT_EQ(motor->joint.link, "upper");
  EXPECT_TRUE(motor->joint.isSliding);
  expectNear(motor->joint.axis, Vec3::UnitZ());
  settings.clamps["hand"].motor = "";
  EXPECT_FALSE(robotOf(kArm, settings).grippers.at(0).motor);
}

TEST(GripMotor, RefusesAJointThatMovesNoPlateAgainstTheOther) {
  RobotSettings settings;
  settings.clamps["hand"] = {{"lower", "upper"}, "finger", 0.5};
  EXPECT_EQ(errorOf(kArm, settings),
            "unknown joint 'finger' (known: lower_joint, shoulder, upper_joint, wrist)");
  settings.clamps["hand"].motor = "lower_joint";
  EXPECT_EQ(errorOf(kArm, settings),
            "joint 'lower_joint': expected one that slides or turns about an axis");
  std::string arm = kArm;
  arm.replace(arm.find("\"wrist\" type=\"fixed\""), 20, "\"wrist\" type=\"continuous\"");
  settings.clamps["hand"].motor = "wrist";
  EXPECT_EQ(errorOf(arm, settings), "joint 'wrist' does not move one plate against the other");
}

/// A sliding joint presses with its effort, whatever the direction of its axis is called.
TEST(GripMotor, ASlidingJointPressesWithItsEffort) {
  GripMotor motor{"finger", {"upper", Vec3::UnitZ(), true}, 1, 0.4};
  const std::array<Vec3, 2> middles{Vec3(0.1, 0.0, -0.01), Vec3(0.1, 0.0, 0.01)};
  const Pose joint{Vec3(0.05, 0.0, 0.0), Quat::Identity()};
  EXPECT_NEAR(gripForce(motor, 10.0, joint, middles).value(), 8.0, 1e-12);
  EXPECT_NEAR(gripForce(motor, -10.0, joint, middles).value(), 8.0, 1e-12);
  const Quat inclined(Eigen::AngleAxisd(M_PI / 3.0, Vec3::UnitX()));
  EXPECT_NEAR(gripForce(motor, 10.0, {joint.position, inclined}, middles).value(), 16.0, 1e-9)
      << "half of its motion closes the gap, so it presses twice as hard";
}

TEST(GripMotor, AJointThatTurnsPressesByItsLever) {
  const GripMotor motor{"finger", {"lower", Vec3::UnitY(), false}, 0, 0.5};
  const std::array<Vec3, 2> middles{Vec3(0.08, 0.02, -0.01), Vec3(0.08, 0.02, 0.01)};
  const Pose joint{Vec3(0.03, 0.5, 0.3), Quat::Identity()};
  EXPECT_NEAR(gripForce(motor, 2.0, joint, middles).value(), 2.0 / 0.05, 1e-9);
}

TEST(GripMotor, TellsNoForceWithoutALeverOrANumber) {
  const GripMotor motor{"finger", {"upper", Vec3::UnitX(), true}, 1, 0.5};
  const std::array<Vec3, 2> middles{Vec3(0.0, 0.0, -0.01), Vec3(0.0, 0.0, 0.01)};
  EXPECT_FALSE(gripForce(motor, 10.0, Pose(), middles)) << "it slides along the plates";
  GripMotor across = motor;
  across.joint.axis = Vec3::UnitZ();
  EXPECT_FALSE(gripForce(across, std::nan(""), Pose(), middles));
  EXPECT_FALSE(gripForce(across, 10.0, Pose(), {Vec3::Zero(), Vec3::Zero()})) << "no direction";
  EXPECT_NEAR(gripForce(across, 0.0, Pose(), middles).value(), 1e-3, 1e-12)
      << "a motor that is off";
}

// ---- clamps between fingers -------------------------------------------------------------------

TEST(GripperPlates, TheClampIsBetweenTheirInnerSides) {
  RobotSettings settings;
  settings.clamps["hand"].plates = {"lower", "upper"};
  const RobotGripper gripper = robotOf(kArm, settings).grippers.at(0);
  EXPECT_EQ(gripper.base, "palm");
  EXPECT_EQ(gripper.plates[0].frame, "lower");
  const Pose lower{Vec3(0.0, 0.0, -0.01), Quat::Identity()};
  const Pose upper{Vec3(0.0, 0.0, 0.02), Quat::Identity()};
  const auto placed = placeBetween(gripper.plates, {lower, upper});
  ASSERT_TRUE(placed);
  // The inner sides are at -0.01 + 0.002 and 0.02 - 0.004.
  EXPECT_NEAR(placed->gap, 0.024, 1e-12);
  expectNear(placed->pose.position, Vec3(0.05, 0.0, 0.004));
  expectNear(placed->pose.orientation * Vec3::UnitZ(), Vec3::UnitZ());
  expectNear(placed->pose.orientation * Vec3::UnitX(), Vec3::UnitX());
}

/// Plates that turn together take the clamp along.
TEST(GripperPlates, TheClampTurnsWithThem) {
  const std::array<GripperPlate, 2> plates{{{"a", {Vec3::Zero(), Vec3(0.01, 0.02, 0.001)}},
                                            {"b", {Vec3::Zero(), Vec3(0.01, 0.02, 0.001)}}}};
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -1.0).normalized()));
  const Pose a{turn * Vec3(0.0, 0.0, -0.02), turn};
  const Pose b{turn * Vec3(0.0, 0.0, 0.02), turn};
  const auto placed = placeBetween(plates, {a, b});
  ASSERT_TRUE(placed);
  EXPECT_NEAR(placed->gap, 0.038, 1e-12);
  EXPECT_NEAR(placed->pose.orientation.angularDistance(turn), 0.0, 1e-7);
  EXPECT_FALSE(placeBetween(plates, {a, a})) << "no direction";
}

TEST(GripperPlates, OverlappingPlatesHaveNoGap) {
  const std::array<GripperPlate, 2> plates{
      {{"a", {Vec3::Zero(), Vec3::Constant(0.01)}}, {"b", {Vec3::Zero(), Vec3::Constant(0.01)}}}};
  const auto placed = placeBetween(plates, {Pose{}, Pose{Vec3(0.0, 0.0, 0.015), Quat::Identity()}});
  ASSERT_TRUE(placed);
  EXPECT_EQ(placed->gap, 0.0);
}

TEST(GripperPlates, ACarriedBodyMovesWithItsFrame) {
  MovingPose frame;
  frame.pose = {Vec3(1.0, 0.0, 0.0), Quat(Eigen::AngleAxisd(M_PI / 2.0, Vec3::UnitZ()))};
  frame.linear = Vec3(0.0, 0.0, 0.5);
  frame.angular = Vec3(0.0, 0.0, 2.0);
  frame.horizon = 0.02;
  const MovingPose body = carried(frame, {Vec3(0.1, 0.0, 0.0), Quat::Identity()});
  expectNear(body.pose.position, Vec3(1.0, 0.1, 0.0));
  expectNear(body.linear, Vec3(-0.2, 0.0, 0.5));
  expectNear(body.angular, frame.angular);
  EXPECT_EQ(body.horizon, frame.horizon);
}

}  // namespace
}  // namespace cloth_sim
