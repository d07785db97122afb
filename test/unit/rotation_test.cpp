#include "support/rotation.h"

#include <gtest/gtest.h>

#include "cloth_sim/contact/collider.h"
#include "cloth_sim/sim/obstacle_guides.h"

namespace cloth_sim {
namespace {

constexpr double kTiny = 1e-200;  ///< its square is zero
constexpr double kDt = 1.0 / 60.0;

TEST(Rotation, TurnsThereAndBack) {
  const Quat start(Eigen::AngleAxisd(0.4, Vec3(1.0, 2.0, -0.5).normalized()));
  const Vec3 velocity(0.3, -1.0, 2.0);
  const Quat end = turned(start, velocity, kDt);
  EXPECT_LT((rotationVector(end * start.conjugate()) - kDt * velocity).norm(), 1e-15);
  EXPECT_LT((turned(end, velocity, -kDt).coeffs() - start.coeffs()).norm(), 1e-15);
}

TEST(Rotation, ThatIsTooSmallToHaveANormIsNone) {
  const Quat start(Eigen::AngleAxisd(0.4, Vec3::UnitY()));
  EXPECT_EQ(turned(start, Vec3(kTiny, 0.0, -kTiny), kDt).coeffs(), start.coeffs());
  EXPECT_EQ(rotationVector(Quat(1.0, kTiny, 0.0, kTiny)), Vec3::Zero());
}

/// Products of round-off in the joints of a robot are as small as that.
TEST(Rotation, ThatIsTooSmallToHaveANormLeavesAnObstacleInItsPlace) {
  Obstacle ball;
  ball.name = "ball";
  ball.shape = SphereShape{0.1};
  Collider turning(ball, 0.0);
  turning.place(Pose(), Vec3::Zero(), 0.0, Vec3(kTiny, 0.0, 0.0));
  EXPECT_EQ(turning.poseAt(1.0).orientation.coeffs(), Quat::Identity().coeffs());

  ColliderSet colliders;
  colliders.add(ball, {ContactProperties()});
  ObstacleGuides guides;
  MovingPose target;
  target.pose.orientation = Quat(1.0, kTiny, kTiny, 0.0);
  guides.set("ball", target);
  guides.steer(0.0, kDt, colliders);
  EXPECT_TRUE(colliders.find("ball")->poseAt(kDt).orientation.coeffs().allFinite());
}

}  // namespace
}  // namespace cloth_sim
