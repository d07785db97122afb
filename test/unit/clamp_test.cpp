#include "cloth_sim/clamp/clamp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace cloth_sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kDt = 1.0 / 60.0;

ClampSpec spec() {
  ClampSpec result;
  result.name = "left";
  return result;
}

Vec3 randomVector(std::mt19937& random, double range) {
  std::uniform_real_distribution<double> coordinate(-range, range);
  const double x = coordinate(random);
  const double y = coordinate(random);
  return Vec3(x, y, coordinate(random));
}

Quat randomRotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double w = normal(random), x = normal(random), y = normal(random);
  return Quat(w, x, y, normal(random)).normalized();
}

double angleBetween(const Quat& a, const Quat& b) {
  const Quat difference = a.conjugate() * b;
  return 2.0 * std::atan2(difference.vec().norm(), std::abs(difference.w()));
}

State stateAt(std::vector<Vec3> positions) {
  State state;
  state.v = VertexData<Vec3>(positions.size(), Vec3::Zero());
  state.x = VertexData<Vec3>(std::move(positions));
  return state;
}

/// An empty cloth to move above.
struct Nothing {
  Model model;
  State state;
};

/// Steps until the clamp has closed.
void closeFully(Clamp& clamp, const Model& model, const State& state,
                Squeeze how = Squeeze::kEach) {
  clamp.close();
  for (int k = 0; k < 1000 && clamp.state() != ClampState::kClosed; ++k) {
    clamp.advance(model, state, kDt, how);
  }
  ASSERT_EQ(clamp.state(), ClampState::kClosed);
}

std::vector<KinematicTarget> targetsOf(const Clamp& clamp) {
  std::vector<KinematicTarget> targets;
  clamp.appendTargets(targets);
  return targets;
}

// ---- specification

TEST(ClampSpecification, RefusesNonsense) {
  const auto refuses = [](auto change) {
    ClampSpec bad = spec();
    change(bad);
    EXPECT_THROW(Clamp{bad}, std::invalid_argument);
  };
  refuses([](ClampSpec& s) { s.plateSize.x() = 0.0; });
  refuses([](ClampSpec& s) { s.gapClosed = 0.0; });
  refuses([](ClampSpec& s) { s.gapOpen = s.gapClosed; });
  refuses([](ClampSpec& s) { s.closingSpeed = -1.0; });
  refuses([](ClampSpec& s) { s.maxLinearSpeed = 0.0; });
  refuses([](ClampSpec& s) { s.maxAngularSpeed = std::numeric_limits<double>::infinity(); });
  refuses([](ClampSpec& s) { s.maxLinearAcceleration = 0.0; });
  refuses([](ClampSpec& s) { s.pose.orientation.coeffs().setZero(); });
  refuses([](ClampSpec& s) { s.pose.position.x() = std::nan(""); });
  EXPECT_NO_THROW(Clamp{spec()});
}

// ---- motion

TEST(ClampMotion, KeepsItsLimitsWhateverItIsTold) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> patience(1, 40);
  Clamp clamp(spec());
  const Nothing nothing;
  const double alpha = spec().maxLinearAcceleration / kClampArm;
  for (int command = 0; command < 300; ++command) {
    clamp.setTarget({randomVector(random, 0.3), randomRotation(random)});
    for (int k = patience(random); k > 0; --k) {
      const Pose before = clamp.pose();
      const Vec3 v = clamp.linearVelocity();
      const Vec3 w = clamp.angularVelocity();
      clamp.advance(nothing.model, nothing.state, kDt);
      const double eps = 1.0 + 1e-12;
      EXPECT_LE(clamp.linearVelocity().norm(), spec().maxLinearSpeed * eps);
      EXPECT_LE(clamp.angularVelocity().norm(), spec().maxAngularSpeed * eps);
      EXPECT_LE((clamp.linearVelocity() - v).norm(), spec().maxLinearAcceleration * kDt * eps);
      EXPECT_LE((clamp.angularVelocity() - w).norm(), alpha * kDt * eps);
      // The velocities are those of the pose.
      const Vec3 moved = clamp.pose().position - before.position;
      EXPECT_LT((moved - clamp.linearVelocity() * kDt).norm(), 1e-15);
      EXPECT_NEAR(angleBetween(before.orientation, clamp.pose().orientation),
                  clamp.angularVelocity().norm() * kDt, 1e-12);
    }
  }
}

TEST(ClampMotion, ArrivesFromAnywhereAfterTheLastCommand) {
  std::mt19937 random(6);
  Clamp clamp(spec());
  const Nothing nothing;
  for (int trial = 0; trial < 50; ++trial) {
    clamp.setTarget({randomVector(random, 0.5), randomRotation(random)});
    for (int k = 0; k < 20; ++k) clamp.advance(nothing.model, nothing.state, kDt);
    clamp.setTarget({randomVector(random, 0.5), randomRotation(random)});
    for (int k = 0; k < 300 && !clamp.atTarget(); ++k) {
      clamp.advance(nothing.model, nothing.state, kDt);
    }
    EXPECT_TRUE(clamp.atTarget());
  }
}

/// Steps until a clamp of the given limits has covered `distance`; -1 if it overshoots.
int stepsToArrive(double distance, double speed, double acceleration) {
  ClampSpec quick = spec();
  quick.maxLinearSpeed = speed;
  quick.maxLinearAcceleration = acceleration;
  Clamp clamp(quick);
  const Vec3 direction = Vec3(1.0, -2.0, 0.5).normalized();
  clamp.setTarget({distance * direction, Quat::Identity()});
  const Nothing nothing;
  for (int k = 0; k < 100000; ++k) {
    if (clamp.atTarget()) return k;
    clamp.advance(nothing.model, nothing.state, kDt);
    const double along = clamp.pose().position.dot(direction);
    if (along > distance + 1e-12) return -1;
    EXPECT_LT((clamp.pose().position - along * direction).norm(), 1e-12);  // on the straight line
  }
  return 100000;
}

TEST(ClampMotion, ArrivesInTheTimeOfTheTrapezoidWithoutOvershoot) {
  for (const double distance : {1e-4, 0.01, 0.05, 0.3, 1.0, 7.77}) {
    for (const double acceleration : {0.5, 10.0, 1000.0}) {
      const double speed = 0.5;
      const double ramp = speed * speed / acceleration;  // covered by speeding up and braking
      const double expected = distance > ramp ? distance / speed + speed / acceleration
                                              : 2.0 * std::sqrt(distance / acceleration);
      const int steps = stepsToArrive(distance, speed, acceleration);
      ASSERT_GE(steps, 0) << "overshoot at " << distance << " m, " << acceleration << " m/s^2";
      // Speeding up, the top and braking each round up to whole steps; one more to stand still.
      EXPECT_NEAR(steps * kDt, expected, 4.0 * kDt) << distance << " " << acceleration;
    }
  }
}

TEST(ClampMotion, TurnsAlongTheShortestArcAlsoTowardsMinusQ) {
  const Vec3 axis = Vec3(1.0, 1.0, -1.0).normalized();
  const double angle = 2.5;
  const Quat goal(Eigen::AngleAxisd(angle, axis));
  const Quat minus(-goal.w(), -goal.x(), -goal.y(), -goal.z());
  const Nothing nothing;
  for (const Quat& q : {goal, minus}) {
    Clamp clamp(spec());
    clamp.setTarget({Vec3::Zero(), q});
    double turned = 0.0;
    for (int k = 0; k < 200; ++k) {
      clamp.advance(nothing.model, nothing.state, kDt);
      const double now = angleBetween(Quat::Identity(), clamp.pose().orientation);
      EXPECT_GE(now, turned - 1e-12);
      EXPECT_LE(now, angle + 1e-12);
      if (now > 1e-3) {
        EXPECT_GT(Eigen::AngleAxisd(clamp.pose().orientation).axis().dot(axis), 1.0 - 1e-9);
      }
      turned = now;
    }
    EXPECT_TRUE(clamp.atTarget());
  }
}

TEST(ClampMotion, ASpeedLimitSlowsItDownWithinItsAcceleration) {
  Clamp clamp(spec());
  const Nothing nothing;
  clamp.setTarget({Vec3(10.0, 0.0, 0.0), Quat::Identity()});
  for (int k = 0; k < 60; ++k) clamp.advance(nothing.model, nothing.state, kDt);
  EXPECT_NEAR(clamp.linearVelocity().x(), 0.5, 1e-12);
  clamp.setSpeedLimit(0.1);
  clamp.advance(nothing.model, nothing.state, kDt);
  EXPECT_NEAR(clamp.linearVelocity().x(), 0.5 - 10.0 * kDt, 1e-12);
  for (int k = 0; k < 10; ++k) clamp.advance(nothing.model, nothing.state, kDt);
  EXPECT_NEAR(clamp.linearVelocity().x(), 0.1, 1e-12);
  clamp.setSpeedLimit(3.0);  // does not raise the spec's own
  for (int k = 0; k < 10; ++k) clamp.advance(nothing.model, nothing.state, kDt);
  EXPECT_NEAR(clamp.linearVelocity().x(), 0.5, 1e-12);
}

// ---- grasping

TEST(ClampGrasp, ClosesAtItsSpeedAndOpensAgain) {
  Clamp clamp(spec());
  const Nothing nothing;
  EXPECT_EQ(clamp.state(), ClampState::kOpen);
  clamp.close();
  EXPECT_EQ(clamp.state(), ClampState::kClosing);
  int steps = 0;
  while (clamp.state() == ClampState::kClosing && ++steps < 1000) {
    const double before = clamp.gap();
    clamp.advance(nothing.model, nothing.state, kDt);
    EXPECT_LE(before - clamp.gap(), spec().closingSpeed * kDt + 1e-15);
  }
  EXPECT_NEAR(steps * kDt, (spec().gapOpen - spec().gapClosed) / spec().closingSpeed, kDt);
  EXPECT_EQ(clamp.gap(), spec().gapClosed);
  clamp.release();
  EXPECT_EQ(clamp.state(), ClampState::kOpen);
  for (int k = 0; k < 60; ++k) clamp.advance(nothing.model, nothing.state, kDt);
  EXPECT_EQ(clamp.gap(), spec().gapOpen);
}

TEST(ClampGrasp, TakesWhatIsBetweenThePlates) {
  const Pose pose{Vec3(1.0, 2.0, 3.0), Quat(Eigen::AngleAxisd(0.8, Vec3::UnitX()))};
  ClampSpec tilted = spec();
  tilted.pose = pose;
  Clamp clamp(tilted);
  const State state = stateAt({
      pose.toWorld(Vec3(0.0, 0.0, 0.0)), pose.toWorld(Vec3(0.029, -0.029, 0.005)),
      pose.toWorld(Vec3(0.031, 0.0, 0.0)),  // beside the plates
      pose.toWorld(Vec3(0.0, 0.0, 0.055)),  // between the open plates
      pose.toWorld(Vec3(0.0, 0.0, 0.065)),  // behind a plate
  });
  closeFully(clamp, Model(), state);
  EXPECT_THAT(clamp.held(), ElementsAre(0, 1, 3));
}

TEST(ClampGrasp, TakesEachParticleWhenAPlateReachesIt) {
  Clamp clamp(spec());
  const State state = stateAt({Vec3(0.0, 0.0, 0.03), Vec3(0.01, 0.0, -0.001)});
  clamp.close();
  while (clamp.gap() > 0.06 + 1e-12) {
    EXPECT_THAT(clamp.held(), IsEmpty());
    clamp.advance(Model(), state, kDt);
  }
  clamp.advance(Model(), state, kDt);
  EXPECT_EQ(clamp.state(), ClampState::kClosing);
  EXPECT_THAT(clamp.held(), ElementsAre(0));
}

TEST(ClampGrasp, HoldsAParticleThatOutrunsAPlate) {
  Clamp clamp(spec());
  State state = stateAt({Vec3(0.0, 0.0, -0.05)});
  state.v[0] = Vec3(0.0, 0.0, -2.0);
  clamp.close();
  for (int k = 0; k < 10 && clamp.held().empty(); ++k) {
    clamp.advance(Model(), state, kDt);
    state.x[0] += state.v[0] * kDt;
  }
  EXPECT_THAT(clamp.held(), ElementsAre(0));
}

TEST(ClampGrasp, FlattensWithoutJumps) {
  Clamp clamp(spec());
  std::vector<Vec3> places;
  for (int k = -10; k <= 10; ++k) places.push_back(Vec3(0.002 * k, 0.0, 0.0055 * k));
  const State state = stateAt(places);
  clamp.close();
  std::vector<Vec3> last = places;
  const double travel = 0.5 * spec().closingSpeed * kDt;
  for (int k = 0; k < 60; ++k) {
    clamp.advance(Model(), state, kDt);
    for (const KinematicTarget& target : targetsOf(clamp)) {
      Vec3& before = last[static_cast<std::size_t>(target.vertex)];
      EXPECT_LE((target.position - before).norm(), travel + 1e-15);
      EXPECT_NEAR(target.velocity.z() * kDt, target.position.z() - before.z(), 1e-15);
      EXPECT_LE(std::abs(target.position.z()), 0.5 * clamp.gap() + travel + 1e-12);
      before = target.position;
    }
  }
  ASSERT_EQ(clamp.held().size(), places.size());
  for (const KinematicTarget& target : targetsOf(clamp)) {
    EXPECT_LE(std::abs(target.position.z()), 0.5 * spec().gapClosed + 1e-15);
    EXPECT_EQ(target.position.x(), places[static_cast<std::size_t>(target.vertex)].x());
    EXPECT_EQ(target.velocity, Vec3::Zero());
  }
}

/// A flat 10 x 8 grid with 1 cm cells, without springs.
struct GridCloth {
  Model model;
  State state;

  GridCloth() {
    model.cloths[0].grid = Grid{10, 8, 0.09, 0.07};
    std::vector<Vec3> places;
    for (int j = 0; j < 8; ++j) {
      for (int i = 0; i < 10; ++i) places.push_back(Vec3(0.01 * i, 0.01 * j, 0.0));
    }
    state = stateAt(places);
  }
};

TEST(ClampPatchParticles, AreASquareClippedAtTheBorder) {
  const GridCloth cloth;
  EXPECT_THAT(patchParticles(cloth.model, {5, 4, 0}), ElementsAre(45));
  EXPECT_THAT(patchParticles(cloth.model, {0, 0, 1}), ElementsAre(0, 1, 10, 11));
  EXPECT_THAT(patchParticles(cloth.model, {9, 7, 1}), ElementsAre(68, 69, 78, 79));
  EXPECT_EQ(patchParticles(cloth.model, {5, 4, 3}).size(), 49u);
  EXPECT_EQ(patchParticles(cloth.model, {5, 4, 100}).size(), 80u);
  EXPECT_EQ(patchParticles(cloth.model, {5, 4, std::numeric_limits<int>::max()}).size(), 80u);
}

TEST(ClampPatchParticles, RefuseWhatIsNoPatch) {
  const GridCloth cloth;
  EXPECT_THROW(patchParticles(cloth.model, {10, 4, 1}), std::invalid_argument);
  EXPECT_THROW(patchParticles(cloth.model, {5, -1, 1}), std::invalid_argument);
  EXPECT_THROW(patchParticles(cloth.model, {5, 4, 1, 1}), std::invalid_argument) << "one cloth";
  EXPECT_THROW(patchParticles(cloth.model, {5, 4, -1}), std::invalid_argument);
  EXPECT_THROW(patchParticles(Model(), {0, 0, 1}), std::invalid_argument);
}

TEST(ClampPatchParticles, GraspKeepsTheirPlacesAlsoBesideAndBehindThePlates) {
  GridCloth cloth;
  cloth.state.x[45] += Vec3(0.0, 0.0, 0.08);  // behind a plate of the open clamp
  ClampSpec byPatch = spec();
  byPatch.patch = ClampPatch{5, 4, 3};
  byPatch.plateSize = Vec2(0.02, 0.02);
  byPatch.pose.position = cloth.state.x[44];
  Clamp clamp(byPatch);
  closeFully(clamp, cloth.model, cloth.state);
  EXPECT_EQ(clamp.held(), patchParticles(cloth.model, *byPatch.patch));
  for (int k = 0; k < 60; ++k) clamp.advance(cloth.model, cloth.state, kDt);
  for (const KinematicTarget& target : targetsOf(clamp)) {
    Vec3 expected = cloth.state.x[target.vertex];
    expected.z() = std::min(expected.z(), 0.5 * byPatch.gapClosed);
    EXPECT_LT((target.position - expected).norm(), 1e-12);
  }
}

TEST(ClampGrasp, SqueezedTogetherLayersKeepTheirOrder) {
  GridCloth cloth;
  const std::vector<double> heights = {0.08, 0.076, 0.0, -0.061};  // the open plates: 0.06
  for (std::size_t k = 0; k < heights.size(); ++k) cloth.state.x[43 + k].z() = heights[k];
  ClampSpec byPatch = spec();
  byPatch.patch = ClampPatch{5, 4, 3};
  byPatch.pose.position = Vec3(cloth.state.x[45].x(), cloth.state.x[45].y(), 0.0);
  Clamp clamp(byPatch);
  closeFully(clamp, cloth.model, cloth.state, Squeeze::kTogether);
  std::vector<KinematicTarget> before = targetsOf(clamp);
  for (int k = 0; k < 60; ++k) {
    clamp.advance(cloth.model, cloth.state, kDt, Squeeze::kTogether);
    const std::vector<KinematicTarget> now = targetsOf(clamp);
    for (std::size_t i = 0; i < now.size(); ++i) {
      const double moved = (now[i].position - before[i].position).norm();
      EXPECT_LT(moved, 0.5 * byPatch.closingSpeed * kDt + 1e-12) << "no faster than a plate";
    }
    before = now;
  }
  EXPECT_TRUE(clamp.isStill());
  const double factor = 0.5 * byPatch.gapClosed / 0.08;
  for (const KinematicTarget& target : targetsOf(clamp)) {
    EXPECT_NEAR(target.position.z(), factor * cloth.state.x[target.vertex].z(), 1e-12);
  }
}

TEST(ClampGrasp, HeldParticlesMoveRigidlyWithMatchingVelocities) {
  Clamp clamp(spec());
  const State state = stateAt({Vec3(0.02, 0.0, 0.0), Vec3(-0.01, 0.02, 0.004)});
  closeFully(clamp, Model(), state);
  clamp.setTarget({Vec3(0.1, 0.2, 0.3), Quat(Eigen::AngleAxisd(1.0, Vec3::UnitY()))});
  std::vector<KinematicTarget> before = targetsOf(clamp);
  for (int k = 0; k < 30; ++k) {
    clamp.advance(Model(), state, kDt);
    const std::vector<KinematicTarget> now = targetsOf(clamp);
    for (std::size_t i = 0; i < now.size(); ++i) {
      const Vec3 local = clamp.pose().toLocal(now[i].position);
      EXPECT_LT((local - state.x[now[i].vertex]).norm(), 1e-14);
      // The velocity at the end of the step and the mean over it differ by the turn in between,
      // |omega|^2 r dt / 2.
      const Vec3 mean = (now[i].position - before[i].position) / kDt;
      EXPECT_LT((now[i].velocity - mean).norm(), 0.5 * 4.0 * 0.03 * kDt + 1e-12);
    }
    before = now;
  }
}

TEST(ClampGrasp, WaitsForParticlesThatCouldNotFollow) {
  const Model model;
  State state = stateAt({Vec3(0.0, 0.0, 0.0), Vec3(0.01, 0.0, 0.0)});
  Clamp clamp(spec());
  closeFully(clamp, model, state);
  ASSERT_EQ(clamp.held().size(), 2U);
  clamp.setTarget({Vec3(0.0, 1.0, 0.0), Quat::Identity()});
  for (int step = 0; step < 10; ++step) clamp.advance(model, state, kDt);
  const Pose wanted = clamp.pose();
  const double motion = clamp.linearVelocity().norm() * kDt;
  const std::vector<KinematicTarget> targets = targetsOf(clamp);
  for (const KinematicTarget& target : targets) state.x[target.vertex] = target.position;
  state.x[targets[1].vertex].y() -= 0.25 * motion;
  clamp.holdBack(state, kDt);
  EXPECT_NEAR(clamp.pose().position.y(), wanted.position.y() - 0.25 * motion, 1e-12);
  EXPECT_TRUE(clamp.linearVelocity().isZero());
  clamp.advance(model, state, kDt);
  const Pose again = clamp.pose();
  const double second = clamp.linearVelocity().norm() * kDt;
  state.x[targets[1].vertex].y() -= 1.0;
  clamp.holdBack(state, kDt);
  EXPECT_NEAR(clamp.pose().position.y(), again.position.y() - second, 1e-12) << "its step, no more";
}

TEST(ClampGrasp, JumpsOnlyWithoutCloth) {
  Clamp clamp(spec());
  const Pose pose{Vec3(0.0, 0.0, 1.0), Quat::Identity()};
  clamp.place(pose);
  EXPECT_EQ(clamp.pose().position, pose.position);
  EXPECT_TRUE(clamp.atTarget());
  const State state = stateAt({pose.position});
  closeFully(clamp, Model(), state);
  EXPECT_THROW(clamp.place(Pose()), std::logic_error);
  clamp.release();
  EXPECT_THAT(clamp.held(), IsEmpty());
  EXPECT_THAT(targetsOf(clamp), IsEmpty());
  EXPECT_NO_THROW(clamp.place(Pose()));
}

// ---- edits and reactions

TEST(ClampFollow, HoldsCopiesAndWhatIsBetweenHeldParticles) {
  Clamp clamp(spec());
  const State state = stateAt({Vec3(0.01, 0.0, 0.0), Vec3(0.02, 0.01, 0.0), Vec3(0.5, 0.0, 0.0)});
  closeFully(clamp, Model(), state);
  ASSERT_THAT(clamp.held(), ElementsAre(0, 1));
  MeshChanges changes;
  changes.toRevision = 1;
  using Kind = VertexEdit::Kind;
  changes.vertices = {
      {Kind::kCopy, 3, {1, kNone, kNone}, {1.0, 0.0, 0.0}},  // a copy of a held one
      {Kind::kCopy, 4, {3, kNone, kNone}, {1.0, 0.0, 0.0}},  // a copy of that copy
      {Kind::kCopy, 5, {2, kNone, kNone}, {1.0, 0.0, 0.0}},  // a copy of a free one
      {Kind::kInsert, 6, {0, 1, kNone}, {0.5, 0.5, 0.0}},    // between held ones
      {Kind::kInsert, 7, {1, 2, kNone}, {0.5, 0.5, 0.0}},    // half held
      {Kind::kInsert, 8, {0, 1, 6}, {0.25, 0.25, 0.5}},      // in a held face
      {Kind::kInsert, 9, {0, 1, 2}, {0.25, 0.25, 0.5}},      // in a face that is not all held
      {Kind::kMove, 2, {2, 0, 1}, {0.5, 0.25, 0.25}},        // a free one moves
  };
  clamp.applyChanges(changes);
  EXPECT_THAT(clamp.held(), ElementsAre(0, 1, 3, 4, 6, 8));
  const std::vector<KinematicTarget> targets = targetsOf(clamp);
  EXPECT_EQ(targets[2].position, targets[1].position);
  EXPECT_EQ(targets[3].position, targets[1].position);
  EXPECT_LT((targets[4].position - Vec3(0.015, 0.005, 0.0)).norm(), 1e-15);
  EXPECT_LT((targets[5].position - Vec3(0.015, 0.005, 0.0)).norm(), 1e-15);
}

TEST(ClampFollow, RenumbersWhatTookThePlaceOfParticlesThatWereTakenAway) {
  Clamp clamp(spec());
  std::vector<Vec3> places(6, Vec3(0.5, 0.0, 0.0));
  for (int k : {0, 2, 5}) places[k] = Vec3(0.004 * k, 0.0, 0.0);
  closeFully(clamp, Model(), stateAt(places));
  ASSERT_THAT(clamp.held(), ElementsAre(0, 2, 5));
  MeshChanges changes;
  changes.toRevision = 1;
  using Kind = VertexEdit::Kind;
  changes.vertices = {
      {Kind::kRemove, 2, {5, kNone, kNone}, {1.0, 0.0, 0.0}},  // a held one goes, another comes
      {Kind::kRemove, 0, {4, kNone, kNone}, {1.0, 0.0, 0.0}},  // a free one takes its place
      {Kind::kRemove, 3, {3, kNone, kNone}, {1.0, 0.0, 0.0}},  // the last one goes
      {Kind::kRemove, 1, {2, kNone, kNone}, {1.0, 0.0, 0.0}},  // ... and once more
  };
  clamp.applyChanges(changes);
  EXPECT_THAT(clamp.held(), ElementsAre(1));
  ASSERT_EQ(targetsOf(clamp).size(), 1U);
  EXPECT_LT((targetsOf(clamp)[0].position - places[5]).norm(), 1e-15);
}

TEST(ClampReactions, SumToAWrenchAboutItsOrigin) {
  ClampSpec away = spec();
  away.pose.position = Vec3(1.0, 1.0, 1.0);
  Clamp clamp(away);
  const State state = stateAt({Vec3(9.0, 0.0, 0.0), Vec3(1.02, 1.0, 1.0), Vec3(0.98, 1.0, 1.0)});
  closeFully(clamp, Model(), state);
  ASSERT_THAT(clamp.held(), ElementsAre(1, 2));
  // Among the targets of others.
  std::vector<KinematicTarget> targets = targetsOf(clamp);
  targets.insert(targets.begin(), KinematicTarget{0, Vec3(9.0, 0.0, 0.0), Vec3::Zero()});
  const std::vector<Vec3> reactions{Vec3(100.0, 0.0, 0.0), Vec3(0.0, 0.0, -3.0),
                                    Vec3(0.0, 0.0, -1.0)};
  clamp.addReactions(targets, reactions);
  EXPECT_LT((clamp.wrench().force - Vec3(0.0, 0.0, -4.0)).norm(), 1e-14);
  // (0.02, 0, 0) x (0, 0, -3) + (-0.02, 0, 0) x (0, 0, -1) = (0, 0.06 - 0.02, 0)
  EXPECT_LT((clamp.wrench().torque - Vec3(0.0, 0.04, 0.0)).norm(), 1e-14);

  EXPECT_THROW(clamp.addReactions(targets, {}), std::invalid_argument);
  clamp.clearWrench();
  clamp.addReactions({}, {});  // all taken by others
  EXPECT_EQ(clamp.wrench().force, Vec3::Zero());
  clamp.release();
  EXPECT_EQ(clamp.wrench().force, Vec3::Zero());
}

TEST(ClampReactions, OfThePartsOfAStepAreAveraged) {
  Clamp clamp(spec());
  closeFully(clamp, Model(), stateAt({Vec3::Zero()}));
  ASSERT_THAT(clamp.held(), ElementsAre(0));
  clamp.clearWrench();
  clamp.addReactions(targetsOf(clamp), {Vec3(0.0, 0.0, -4.0)}, 0.25);
  clamp.addReactions(targetsOf(clamp), {Vec3(0.0, 8.0, 0.0)}, 0.75);
  EXPECT_EQ(clamp.wrench().force, Vec3(0.0, 6.0, -1.0));
}

}  // namespace
}  // namespace cloth_sim
