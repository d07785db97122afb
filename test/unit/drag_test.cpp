/// \file The pull at one particle.

#include "cloth_sim/clamp/drag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using testing_support::clothOf;
using testing_support::flatState;

constexpr double kStep = 1.0 / 60.0;

/// Returns a ray straight down on (x, y).
Ray downOn(double x, double y) { return {Vec3(x, y, 2.0), Vec3(0.0, 0.0, -3.0)}; }

class DragTest : public testing::Test {
 protected:
  /// Moves the particle as a solver would, for a time.
  void run(double duration) {
    for (long k = 0; k < std::lround(duration / kStep); ++k) {
      drag_.advance(state_, kStep);
      std::vector<KinematicTarget> targets;
      drag_.appendTargets(targets);
      for (const KinematicTarget& target : targets) state_.x[target.vertex] = target.position;
      state_.t += kStep;
    }
  }

  Model model_ = buildModel(clothOf(5, 5, 0.1));
  State state_ = flatState(model_);
  Drag drag_;
};

TEST_F(DragTest, PicksTheParticleAtTheRay) {
  ASSERT_TRUE(drag_.pick(downOn(0.21, 0.09), state_));
  EXPECT_EQ(drag_.vertex(), 5 + 2);
}

TEST_F(DragTest, PicksNothingBesideTheClothOrBehindTheOrigin) {
  EXPECT_FALSE(drag_.pick(downOn(0.2, -0.06), state_));
  EXPECT_EQ(drag_.vertex(), kNone);
  EXPECT_FALSE(drag_.pick({Vec3(0.2, 0.1, -1.0), Vec3(0.0, 0.0, -1.0)}, state_));
  std::vector<KinematicTarget> targets;
  drag_.advance(state_, kStep);
  drag_.appendTargets(targets);
  EXPECT_TRUE(targets.empty());
}

TEST_F(DragTest, OfSeveralLayersPicksTheFirst) {
  state_.x[24] = Vec3(0.2, 0.1, 0.5);  // above particle 7
  ASSERT_TRUE(drag_.pick(downOn(0.2, 0.1), state_));
  EXPECT_EQ(drag_.vertex(), 24);
}

TEST_F(DragTest, DoesNotJumpWhenItIsPicked) {
  const Ray ray = downOn(0.22, 0.1);
  ASSERT_TRUE(drag_.pick(ray, state_));
  drag_.aim(ray, state_.t);
  const Vec3 before = state_.x[drag_.vertex()];
  run(0.5);
  EXPECT_NEAR((state_.x[drag_.vertex()] - before).norm(), 0.0, 1e-12);
}

TEST_F(DragTest, FollowsTheRayAtItsSpeedAndArrives) {
  ASSERT_TRUE(drag_.pick(downOn(0.2, 0.1), state_));
  drag_.aim(downOn(1.2, 0.1), state_.t);
  run(0.2);
  EXPECT_NEAR(state_.x[7].x(), 0.2 + 0.2 * 1.5, 1e-9) << "1.5 m/s at most";
  run(0.8);
  EXPECT_NEAR(state_.x[7].x(), 1.2, 1e-3);
  EXPECT_NEAR(state_.x[7].z(), 0.0, 1e-9) << "at the depth that it was picked at";
}

TEST_F(DragTest, LetsGoWhenNobodyAimsAnyMore) {
  ASSERT_TRUE(drag_.pick(downOn(0.2, 0.1), state_));
  drag_.aim(downOn(0.2, 0.1), state_.t);
  run(Drag::kPatience - kStep);
  EXPECT_EQ(drag_.vertex(), 7);
  run(3.0 * kStep);
  EXPECT_EQ(drag_.vertex(), kNone);
}

TEST_F(DragTest, GoesAlongWithItsParticleWhenVerticesAreRenumbered) {
  ASSERT_TRUE(drag_.pick(downOn(0.4, 0.4), state_));
  ASSERT_EQ(drag_.vertex(), 24);
  MeshChanges changes;
  changes.vertices.push_back({VertexEdit::Kind::kRemove, 3, {24, kNone, kNone}, {1.0, 0.0, 0.0}});
  drag_.applyChanges(changes);
  EXPECT_EQ(drag_.vertex(), 3);
  changes.vertices[0].from[0] = 23;
  drag_.applyChanges(changes);
  EXPECT_EQ(drag_.vertex(), kNone) << "it is gone";
}

TEST(Ray, BadOnesAreNamed) {
  EXPECT_EQ(validationError(downOn(0.0, 0.0)), "");
  EXPECT_NE(validationError({Vec3::Zero(), Vec3::Zero()}), "");
  EXPECT_NE(validationError({Vec3::Constant(NAN), Vec3::UnitX()}), "");
  EXPECT_NE(validationError({Vec3::Zero(), Vec3(INFINITY, 0.0, 0.0)}), "");
}

}  // namespace
}  // namespace cloth_sim
