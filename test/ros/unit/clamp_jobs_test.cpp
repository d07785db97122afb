/// \file Goals of clamps, step by step, without a node and without a master.

#include "ros/clamp_jobs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cloth_sim/scene/load.h"
#include "ros/grip_job.h"
#include "ros/move_job.h"

namespace cloth_sim {
namespace {

using Outcome = ClampJobResult::Outcome;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

const char* const kScene = R"(
cloth: {size: [0.2, 0.2], particles: [5, 5], pins: [first_row, last_row]}
clamps:
  hand: {pose: {position: [0.1, 0.0, 0.0]}, gap_open: 0.08}
  far: {pose: {position: [0.0, 0.0, 0.9]}, patch: {particle: [2, 2], radius: 0}}
solver: {method: xpbd, substeps: 4}
gravity: [0, 0, 0]
)";

/// A simulation with goals of its clamps, and every command that they gave.
class ClampJobsTest : public testing::Test {
 protected:
  ClampJobListener listener() {
    return {[this] { ++accepted_; }, [this](const ClampJobResult& end) { ends_.push_back(end); }};
  }
  void grip(double width, std::optional<double> force = std::nullopt, const char* clamp = "hand") {
    jobs_.start(std::make_shared<GripJob>(clamp, width, force, listener()));
  }
  std::shared_ptr<MoveJob> move(const MovePlan& plan) {
    progress_ = std::make_shared<MoveProgress>();
    auto job = std::make_shared<MoveJob>("hand", plan, progress_, listener());
    jobs_.start(job);
    return job;
  }
  void step(int count = 1) {
    for (int k = 0; k < count; ++k) {
      simulation_.step();
      jobs_.tend();
    }
  }
  void stepUntilOver(int most = 1000) {
    const std::size_t before = ends_.size();
    for (int k = 0; k < most && ends_.size() == before; ++k) step();
  }
  const Clamp& hand() const { return simulation_.clamps()[0]; }
  double way() const { return hand().pose().position.x() - 0.1; }

  static Waypoint along(double x, double time = 0.0) {
    return {{Vec3(0.1 + x, 0.0, 0.0), Quat::Identity()}, time};
  }
  static MovePlan plan(std::vector<Waypoint> waypoints, bool timed = false) {
    MovePlan result;
    result.waypoints = std::move(waypoints);
    result.timed = timed;
    return result;
  }

  Simulation simulation_{parseScene(kScene, "test")};
  std::vector<std::pair<std::uint64_t, Command>> commands_;  ///< with the number of steps before
  ClampJobs jobs_{simulation_, [this](const Command& command) {
                    const CommandResult result = simulation_.apply(command);
                    if (result.success) commands_.emplace_back(simulation_.stepCount(), command);
                    return result;
                  }};
  std::shared_ptr<MoveProgress> progress_;
  std::vector<ClampJobResult> ends_;
  int accepted_ = 0;
};

TEST_F(ClampJobsTest, ClosingEndsWhenThePlatesHaveClosed) {
  grip(0.0, 5.0);
  EXPECT_EQ(accepted_, 1);
  stepUntilOver();
  ASSERT_EQ(ends_.size(), 1u);
  EXPECT_EQ(ends_[0].outcome, Outcome::kReached);
  EXPECT_EQ(hand().state(), ClampState::kClosed);
  EXPECT_DOUBLE_EQ(ends_[0].gap, 0.02);
  // 0.06 m at 0.2 m/s.
  EXPECT_NEAR(ends_[0].time, 0.3, 1.5 / 60.0);
  EXPECT_EQ(ends_[0].held, hand().held());
  EXPECT_FALSE(ends_[0].held.empty());
  EXPECT_EQ(hand().spec().gripForce, 5.0);
  grip(0.0);
  jobs_.tend();
  EXPECT_EQ(ends_.size(), 2u) << "it is closed already";
  grip(0.05000001);  // more than the middle
  stepUntilOver();
  ASSERT_EQ(ends_.size(), 3u);
  EXPECT_DOUBLE_EQ(ends_[2].gap, 0.08);
  EXPECT_TRUE(ends_[2].held.empty());
}

TEST_F(ClampJobsTest, GripErrorsNameTheField) {
  EXPECT_EQ(gripError(0.0, 0.0), "");
  EXPECT_EQ(gripError(-1.0, 3.0), "") << "narrower than closed is closed";
  EXPECT_THAT(gripError(kNan, 0.0), HasSubstr("position"));
  EXPECT_THAT(gripError(0.0, -1.0), HasSubstr("max_effort"));
  EXPECT_THAT(gripError(0.0, kNan), HasSubstr("max_effort"));
}

TEST_F(ClampJobsTest, ARefusedGoalChangesNothingAndLeavesTheOneUnderWay) {
  grip(0.0);
  grip(0.0, 5.0, "far");
  ASSERT_EQ(ends_.size(), 1u);
  EXPECT_EQ(ends_[0].outcome, Outcome::kRefused);
  EXPECT_THAT(ends_[0].message, HasSubstr("clamp 'far' is 0.900 m from its patch"));
  EXPECT_FALSE(simulation_.clamps()[1].spec().gripForce.has_value());
  grip(0.0, std::nullopt, "nobody");
  EXPECT_EQ(ends_.back().outcome, Outcome::kRefused);
  EXPECT_THAT(ends_.back().message, HasSubstr("hand"));
  stepUntilOver();
  EXPECT_EQ(ends_.back().outcome, Outcome::kReached);
}

TEST_F(ClampJobsTest, MovesInTime) {
  move(plan({along(0.1, 0.5), along(0.3, 1.5)}, true));
  step(30);
  EXPECT_NEAR(way(), 0.1, 1e-3);
  EXPECT_EQ(progress_->waypoint, 1u);
  step(30);
  EXPECT_NEAR(way(), 0.2, 1e-3);
  EXPECT_NEAR(progress_->distance, 0.1, 1e-3);
  EXPECT_TRUE(ends_.empty());
  stepUntilOver();
  EXPECT_EQ(ends_[0].outcome, Outcome::kReached);
  EXPECT_NEAR(ends_[0].time, 1.5, 1.5 / 60.0);
  step(60);
  EXPECT_NEAR(way(), 0.3, 1e-6);
}

TEST_F(ClampJobsTest, TurnsInTime) {
  Waypoint turned = along(0.0, 1.0);
  turned.pose.orientation = Quat(Eigen::AngleAxisd(1.0, Vec3::UnitZ()));
  move(plan({turned}, true));
  step(30);
  EXPECT_NEAR(angleBetween(hand().pose().orientation, Quat::Identity()), 0.5, 0.01);
  stepUntilOver();
  EXPECT_EQ(ends_[0].outcome, Outcome::kReached);
  EXPECT_NEAR(angleBetween(ends_[0].pose.orientation, turned.pose.orientation), 0.0, 0.01);
}

TEST_F(ClampJobsTest, MovesAtASpeedOrAsFastAsItCan) {
  MovePlan slow = plan({along(0.1), along(0.2)});
  slow.speed = 0.1;
  move(slow);
  stepUntilOver();
  EXPECT_NEAR(ends_[0].time, 2.0, 2.5 / 60.0);
  move(plan({along(0.1), along(0.0)}));
  stepUntilOver();
  EXPECT_EQ(ends_[1].outcome, Outcome::kReached);
  EXPECT_LT(ends_[1].time - ends_[0].time, 1.0) << "0.2 m at 0.5 m/s, with a stop";
  EXPECT_NEAR(way(), 0.0, 1e-3);
}

TEST_F(ClampJobsTest, PlansThatTheClampCannotKeepAreRefused) {
  const auto refusal = [&](const MovePlan& bad) {
    move(bad);
    EXPECT_EQ(ends_.back().outcome, Outcome::kRefused);
    EXPECT_TRUE(commands_.empty());
    return ends_.back().message;
  };
  EXPECT_THAT(refusal(plan({along(1.0, 1.0)}, true)), HasSubstr("poses[0]: expected at most"));
  EXPECT_THAT(refusal(plan({along(0.1, 1.0), along(1.2, 2.0)}, true)), HasSubstr("poses[1]"));
  EXPECT_THAT(refusal(plan({along(0.1, 0.0)}, true)), HasSubstr("0.1 m away"));
  Waypoint turned = along(0.0, 0.5);
  turned.pose.orientation = Quat(Eigen::AngleAxisd(2.0, Vec3::UnitZ()));
  EXPECT_THAT(refusal(plan({turned}, true)), HasSubstr("2 rad/s on the way there (got 4)"));
  MovePlan fast = plan({along(0.1)});
  fast.speed = 0.6;
  EXPECT_THAT(refusal(fast), HasSubstr("0.5 m/s (got 0.6)"));
  EXPECT_EQ(accepted_, 0);
}

TEST_F(ClampJobsTest, PlansThatMakeNoSenseHaveAnError) {
  EXPECT_EQ(validationError(plan({along(0.0, 0.0), along(0.1, 1.0)}, true)), "");
  EXPECT_THAT(validationError(plan({})), HasSubstr("poses"));
  EXPECT_THAT(validationError(plan({along(0.1, 1.0), along(0.1, 1.0)}, true)),
              HasSubstr("times_from_start[1]"));
  EXPECT_THAT(validationError(plan({along(kNan)})), HasSubstr("poses[0]: position"));
  MovePlan both = plan({along(0.1, 1.0)}, true);
  both.speed = 0.1;
  EXPECT_THAT(validationError(both), HasSubstr("speed: expected 0"));
  MovePlan limit = plan({along(0.1)});
  limit.timeLimit = -1.0;
  EXPECT_THAT(validationError(limit), HasSubstr("time_limit"));
}

TEST_F(ClampJobsTest, ANewGoalACommandAndACancelTakeItsPlace) {
  move(plan({along(1.0)}));
  step(10);
  move(plan({along(0.5)}));
  ASSERT_EQ(ends_.size(), 1u);
  EXPECT_EQ(ends_[0].outcome, Outcome::kPreempted);
  step(10);
  simulation_.apply(SetClampTarget{"hand", along(0.0).pose});
  jobs_.tend();
  ASSERT_EQ(ends_.size(), 2u);
  EXPECT_EQ(ends_[1].outcome, Outcome::kPreempted);
  EXPECT_EQ(hand().target().position.x(), 0.1) << "the command counts";
  const auto third = move(plan({along(1.0, 5.0)}, true));
  step(30);
  const double before = way();
  jobs_.cancel(third.get());
  ASSERT_EQ(ends_.size(), 3u);
  EXPECT_EQ(ends_[2].outcome, Outcome::kCancelled);
  step(60);
  // The clamp brakes from 0.2 m/s with 10 m/s^2.
  EXPECT_NEAR(way(), before + 0.002, 0.004);
  EXPECT_TRUE(hand().atTarget());
}

TEST_F(ClampJobsTest, GivesUpInTimeAndHolds) {
  MovePlan late = plan({along(5.0)});
  late.timeLimit = 0.5;
  move(late);
  stepUntilOver();
  EXPECT_EQ(ends_[0].outcome, Outcome::kTimedOut);
  EXPECT_NEAR(ends_[0].time, 0.5, 1.5 / 60.0);
  step(60);
  EXPECT_TRUE(hand().atTarget());
  EXPECT_LT(way(), 0.3);
}

TEST_F(ClampJobsTest, PlatesAndMotionAreGoalsOfTheirOwn) {
  move(plan({along(0.02)}));
  grip(0.0);
  step(60);
  EXPECT_EQ(ends_.size(), 2u);
  for (const ClampJobResult& end : ends_) EXPECT_EQ(end.outcome, Outcome::kReached);
}

TEST_F(ClampJobsTest, TheCommandsAloneGiveTheSameBits) {
  grip(0.0);
  move(plan({along(0.05, 0.4), along(0.02, 0.9), along(0.05, 1.3)}, true));
  step(100);
  ASSERT_EQ(ends_.size(), 2u);
  Simulation again(parseScene(kScene, "test"));
  std::size_t next = 0;
  while (again.stepCount() < simulation_.stepCount()) {
    for (; next < commands_.size() && commands_[next].first == again.stepCount(); ++next) {
      EXPECT_TRUE(again.apply(commands_[next].second).success);
    }
    again.step();
  }
  EXPECT_EQ(next, commands_.size());
  EXPECT_EQ(stateHash(again.model(), again.state()),
            stateHash(simulation_.model(), simulation_.state()));
}

TEST(MoveJob, IsBlockedByLayersOfCloth) {
  // Two pinned cloths, one above the other; a clamp pushes the patch that it holds into the lower.
  Simulation simulation(parseScene(R"(
cloth:
  - {name: lower, size: [0.2, 0.2], particles: [9, 9], pins: [first_row, last_row, first_column, last_column]}
  - {name: upper, size: [0.2, 0.2], particles: [9, 9], pose: {position: [0, 0, 0.02]}}
self_contact: true
gravity: [0, 0, 0]
solver: {method: line_xpbd, substeps: 4}
clamps:
  floor: {patch: {cloth: lower, particle: [4, 4], radius: 4}, pose: {position: [0, 0, 0]}, plate_size: [0.2, 0.2]}
  hand: {patch: {cloth: upper, particle: [4, 4], radius: 2}, pose: {position: [0, 0, 0.02]}}
)",
                                   "test"));
  std::vector<ClampJobResult> ends;
  const ClampJobListener listener{{}, [&](const ClampJobResult& end) { ends.push_back(end); }};
  ClampJobs jobs(simulation, [&](const Command& command) { return simulation.apply(command); });
  jobs.start(std::make_shared<GripJob>("floor", 0.0, std::nullopt, listener));
  jobs.start(std::make_shared<GripJob>("hand", 0.0, std::nullopt, listener));
  const auto run = [&](std::size_t wanted) {
    for (int k = 0; k < 600 && ends.size() < wanted; ++k) {
      simulation.step();
      jobs.tend();
    }
  };
  run(2);
  ASSERT_EQ(ends.size(), 2u);
  MovePlan down;
  down.waypoints.push_back({{Vec3(0.0, 0.0, -0.1), Quat::Identity()}, 0.0});
  jobs.start(std::make_shared<MoveJob>("hand", down, std::make_shared<MoveProgress>(), listener));
  run(3);
  ASSERT_EQ(ends.size(), 3u);
  EXPECT_EQ(ends[2].outcome, Outcome::kBlocked) << ends[2].message;
  EXPECT_GT(ends[2].pose.position.z(), -0.01);
}

}  // namespace
}  // namespace cloth_sim
