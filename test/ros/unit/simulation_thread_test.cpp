/// \file The mailbox and the pace of the simulation thread.

#include "ros/simulation_thread.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "cloth_sim/scene/load.h"
#include "ros/grip_job.h"

namespace cloth_sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kTimeout{10000};

const char* const kScene = R"(
cloth: {size: [0.2, 0.2], particles: [5, 5], pins: [corner_00, corner_10]}
clamps: {left: {pose: {position: [0.0, 0.0, 0.5]}}}
phases: [{name: first}, {name: second}]
)";

Scene smallScene() { return parseScene(kScene, "test"); }

RunSettings paused() { return {0.0, true, 1, nullptr}; }

template <typename Condition>
bool eventually(Condition condition) {
  const auto end = steady_clock::now() + seconds(10);
  while (!condition()) {
    if (steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

TEST(SimulationThread, PausedStaysAtTheStart) {
  SimulationThread simulation(smallScene(), paused());
  EXPECT_TRUE(simulation.observe().paused);
  EXPECT_EQ(simulation.observe().snapshot->step, 0u);
}

TEST(SimulationThread, MakesExactlyTheStepsAskedFor) {
  SimulationThread simulation(smallScene(), paused());
  EXPECT_EQ(simulation.requestSteps(7).get().step, 7u);
  const StepResult second = simulation.requestSteps(3).get();
  EXPECT_TRUE(second.result.success);
  EXPECT_EQ(second.step, 10u);
  EXPECT_EQ(simulation.observe().snapshot->step, 10u);
}

TEST(SimulationThread, StepsOfTwoClientsAreAllMade) {
  SimulationThread simulation(smallScene(), paused());
  std::future<StepResult> first = simulation.requestSteps(50);
  std::future<StepResult> second = simulation.requestSteps(20);
  EXPECT_EQ(first.get().step, 50u);
  EXPECT_EQ(second.get().step, 70u);
}

TEST(SimulationThread, AskingForStepsPauses) {
  SimulationThread simulation(smallScene(), {0.0, false, 1, nullptr});
  simulation.requestSteps(1).get();
  EXPECT_TRUE(simulation.observe().paused);
  const std::uint64_t step = simulation.observe().snapshot->step;
  EXPECT_EQ(simulation.requestSteps(1).get().step, step + 1);
}

TEST(SimulationThread, GoesOnWhenPauseEnds) {
  SimulationThread simulation(smallScene(), paused());
  simulation.setPaused(false);
  EXPECT_TRUE(eventually([&] { return simulation.observe().snapshot->step > 5; }));
}

TEST(SimulationThread, WhoWaitsForACommandSeesItsEffect) {
  SimulationThread simulation(smallScene(), paused());
  EXPECT_TRUE(simulation.execute(SetPhase{"second"}, kTimeout).success);
  EXPECT_EQ(simulation.observe().snapshot->phase, "second");
  const CommandResult refused = simulation.execute(SetPhase{"third"}, kTimeout);
  EXPECT_FALSE(refused.success);
  EXPECT_NE(refused.message, "");
  EXPECT_EQ(simulation.observe().snapshot->phase, "second");
}

TEST(SimulationThread, ResetGoesBackToTheStartAndIsCounted) {
  SimulationThread simulation(smallScene(), paused());
  simulation.requestSteps(5).get();
  EXPECT_TRUE(simulation.execute(Reset{}, kTimeout).success);
  const Observation now = simulation.observe();
  EXPECT_EQ(now.snapshot->step, 0u);
  EXPECT_EQ(now.snapshot->time, 0.0);
  EXPECT_EQ(now.resets, 1u);
}

TEST(SimulationThread, SpringsThatACommandCutAreToldAtOnce) {
  SimulationThread simulation(smallScene(), paused());
  const Stroke middle =
      strokeAlong({Vec3(-1.0, 0.02, 0.0), Vec3(1.0, 0.02, 0.0)}, Vec3::UnitZ(), 1.0);
  const CommandResult result = simulation.execute(CutAlong{middle}, kTimeout);
  ASSERT_TRUE(result.success) << result.message;
  const Observation now = simulation.observe();
  EXPECT_EQ(now.whole->figures->pieces.size(), 2u);
  EXPECT_GT(now.snapshot->broken.cut, 0);
  EXPECT_EQ(simulation.takeEvents().events.size(),
            static_cast<std::size_t>(now.snapshot->broken.total));
  EXPECT_TRUE(simulation.execute(Reset{}, kTimeout).success);
  EXPECT_EQ(simulation.observe().whole->figures->pieces.size(), 1u);
  const FailureBatch after = simulation.takeEvents();
  EXPECT_TRUE(after.events.empty());
  EXPECT_EQ(after.resets, simulation.observe().resets);
}

TEST(SimulationThread, ResultDoesNotDependOnHowItIsDriven) {
  SimulationThread inOne(smallScene(), paused());
  SimulationThread oneByOne(smallScene(), paused());
  inOne.requestSteps(30).get();
  for (int i = 0; i < 30; ++i) oneByOne.requestSteps(1).get();
  EXPECT_EQ(inOne.observe().snapshot->positions, oneByOne.observe().snapshot->positions);
}

TEST(SimulationThread, FloodOfCommandsIsBoundedAndAnswered) {
  SimulationThread simulation(smallScene(), {1.0, false, 1, nullptr});
  constexpr int kCommands = 5000;
  std::atomic<int> answers{0};
  for (int i = 0; i < kCommands; ++i) {
    simulation.post(SetGrasp{"left", false}, [&](const CommandResult&) { ++answers; });
  }
  EXPECT_TRUE(eventually([&] { return answers == kCommands; }));
}

/// A scene whose steps take about a second.
const char* const kSlowScene = R"(
cloth: {size: [1.0, 1.0], particles: [48, 48], pins: [corner_00, corner_10]}
solver: {method: xpbd, substeps: 10000}
clamps: {left: {pose: {position: [0.0, 0.0, 0.5]}}}
)";

/// Calls every method of callbacks and of the publishing thread that is not meant to wait.
void askForEverything(SimulationThread& simulation, std::atomic<int>& answers) {
  simulation.post(SetGrasp{"left", true}, [&](const CommandResult&) { ++answers; });
  simulation.setRealTimeFactor(0.0);
  simulation.setPaused(true);
  simulation.setObservationRate(60.0);
  simulation.cancelRun(simulation.requestRun(RunFor{1.0}, [](const RunResult&) {}));
  simulation.requestSteps(1);
  simulation.takeEvents();
  simulation.takeGripEvents();
  simulation.takeCommands();
  simulation.observe();
}

/// Requests and observations never wait for the current step: the stepping thread holds no lock
/// while it steps.
TEST(SimulationThread, NobodyWaitsForALongStep) {
  std::atomic<int> told{0};
  std::atomic<int> answers{0};
  RunSettings settings = paused();
  settings.onTime = [&](double) { ++told; };
  SimulationThread simulation(parseScene(kSlowScene, "slow"), settings);
  simulation.requestSteps(2);
  while (told < 2) std::this_thread::yield();  // at the start, and after the first step
  steady_clock::duration longest{};
  const auto start = steady_clock::now();  // the second step begins about now
  while (steady_clock::now() - start < std::chrono::milliseconds(100)) {
    const auto asked = steady_clock::now();
    askForEverything(simulation, answers);
    longest = std::max(longest, steady_clock::now() - asked);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_LT(longest, std::chrono::milliseconds(100));
  ASSERT_EQ(told, 2) << "the step was too short to tell anything, or somebody waited for it";
  EXPECT_FALSE(simulation.execute(SetGrasp{"left", true}, std::chrono::milliseconds(10)).success)
      << "who waits for an answer waits no longer than he said";
  EXPECT_LE(answers, 1) << "commands are carried out between steps";
}

TEST(SimulationThread, WhoWaitsForAnObservationGetsItAtOnce) {
  SimulationThread simulation(smallScene(), paused());
  const std::uint64_t seen = simulation.observe().number;
  simulation.waitForObservation(seen, std::chrono::milliseconds(10));
  EXPECT_EQ(simulation.observe().number, seen) << "there is none, and it does not wait for ever";
  simulation.requestSteps(1);
  const auto start = steady_clock::now();
  simulation.waitForObservation(seen, seconds(10));
  EXPECT_GT(simulation.observe().number, seen);
  EXPECT_LT(steady_clock::now() - start, seconds(5));
}

TEST(SimulationThread, ComputesFiguresAsOftenAsTheyAreAskedFor) {
  SimulationThread simulation(smallScene(), {1.0, false, 1, nullptr});
  simulation.setObservationRate(60.0);
  simulation.setFigureRate(0.01);
  const Observation first = simulation.observe();
  ASSERT_TRUE(eventually([&] { return simulation.observe().number >= first.number + 10; }));
  const Observation later = simulation.observe();
  EXPECT_LT(later.whole->step, later.snapshot->step) << "seldom";
  EXPECT_TRUE(later.whole->figures);
  EXPECT_FALSE(later.snapshot->figures);
  const Observation asked = simulation.observeWhole(milliseconds(5000));
  EXPECT_GE(asked.whole->step, later.snapshot->step) << "those of now";
}

TEST(SimulationThread, KeepsThePaceItIsGiven) {
  SimulationThread simulation(smallScene(), {1.0, false, 1, nullptr});
  const auto start = steady_clock::now();
  ASSERT_TRUE(eventually([&] { return simulation.observe().snapshot->time >= 0.5; }));
  const double wall = std::chrono::duration<double>(steady_clock::now() - start).count();
  EXPECT_GT(wall,
            0.4);  // it may be late on a busy machine, never early by more than an observation
}

/// Starts a run and waits for its end.
RunResult runTo(SimulationThread& simulation, const RunGoal& goal) {
  std::promise<RunResult> promise;
  std::future<RunResult> future = promise.get_future();
  simulation.requestRun(goal, [&](const RunResult& result) { promise.set_value(result); });
  return future.get();
}

TEST(SimulationThread, RunsForAWhileAndPauses) {
  SimulationThread simulation(smallScene(), paused());
  const RunResult result = runTo(simulation, RunFor{0.5});
  EXPECT_EQ(result.outcome, RunResult::Outcome::kReached);
  EXPECT_EQ(result.step, 30u);
  EXPECT_TRUE(simulation.observe().paused);
  EXPECT_EQ(simulation.observe().whole->figures->hash, result.hash);
  EXPECT_EQ(runTo(simulation, RunFor{0.1}).step, 36u);
}

TEST(SimulationThread, RunsToAPhase) {
  SimulationThread simulation(smallScene(), paused());
  EXPECT_EQ(runTo(simulation, RunToPhase{"first"}).step, 1u);
  EXPECT_EQ(runTo(simulation, RunToPhase{"first"}).step, 1u) << "it is there already";
}

TEST(SimulationThread, ARunToAPhaseThatIsPastEndsAtOnce) {
  SimulationThread simulation(smallScene(), paused());
  EXPECT_TRUE(simulation.execute(SetPhase{"second"}, kTimeout).success);
  const RunResult result = runTo(simulation, RunToPhase{"first"});
  EXPECT_EQ(result.outcome, RunResult::Outcome::kFailed);
  EXPECT_EQ(result.step, 0u);
  EXPECT_THAT(result.message, testing::HasSubstr("'first' is past, the script is in 'second'"));
  EXPECT_TRUE(simulation.execute(SetPhase{"first"}, kTimeout).success);
  EXPECT_EQ(runTo(simulation, RunToPhase{"first"}).outcome, RunResult::Outcome::kReached);
}

TEST(SimulationThread, ARunThatIsResetOrReplacedOrCancelledIsAnswered) {
  SimulationThread simulation(smallScene(), paused());
  std::vector<std::string> messages;
  std::mutex mutex;
  const auto note = [&](const RunResult& result) {
    const std::lock_guard<std::mutex> lock(mutex);
    messages.push_back(result.message);
  };
  const auto count = [&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return messages.size();
  };
  simulation.requestRun(RunFor{1e6}, note);
  simulation.requestRun(RunFor{1e6}, note);
  ASSERT_TRUE(eventually([&] { return count() == 1; }));
  EXPECT_TRUE(simulation.execute(Reset{}, kTimeout).success);
  EXPECT_EQ(count(), 2u);
  const std::uint64_t number = simulation.requestRun(RunFor{1e6}, note);
  simulation.cancelRun(number);
  ASSERT_TRUE(eventually([&] { return count() == 3; }));
  EXPECT_TRUE(simulation.observe().paused);
  simulation.requestRun(RunFor{1e6}, note);
  simulation.stop();
  EXPECT_EQ(count(), 4u);
  EXPECT_THAT(messages[0], testing::HasSubstr("another run"));
  EXPECT_THAT(messages[1], testing::HasSubstr("reset"));
  EXPECT_THAT(messages[2], testing::HasSubstr("cancelled"));
  EXPECT_THAT(messages[3], testing::HasSubstr("shutting"));
  EXPECT_EQ(simulation.requestRun(RunFor{1.0}, note), 0u) << "there is nobody to run it";
}

TEST(SimulationThread, RecordsWhatWasCarriedOutAndNothingElse) {
  SimulationThread simulation(smallScene(), paused());
  EXPECT_TRUE(simulation.execute(SetPhase{"second"}, kTimeout).success);
  EXPECT_FALSE(simulation.execute(SetPhase{"third"}, kTimeout).success);
  simulation.requestSteps(3).get();
  EXPECT_TRUE(simulation.execute(SetGrasp{"left", true}, kTimeout).success);
  const std::vector<CommandRecord> records = simulation.takeCommands();
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0].number, 0u);
  EXPECT_EQ(records[0].step, 0u);
  EXPECT_EQ(std::get<SetPhase>(records[0].command).phase, "second");
  EXPECT_EQ(records[1].number, 1u);
  EXPECT_EQ(records[1].step, 3u);
  EXPECT_TRUE(simulation.takeCommands().empty());
}

TEST(SimulationThread, GoalsOfClampsAreAnsweredAndTheirCommandsRecorded) {
  SimulationThread simulation(smallScene(), paused());
  std::vector<ClampJobResult> ends;  // written before requestSteps or stop returns
  const ClampJobListener listener{{}, [&](const ClampJobResult& end) { ends.push_back(end); }};
  const auto grip = [&](double width) {
    const auto job = std::make_shared<GripJob>("left", width, std::nullopt, listener);
    simulation.startJob(job);
    return job;
  };
  grip(0.0);
  simulation.requestSteps(60).get();
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].outcome, ClampJobResult::Outcome::kReached);
  const std::vector<CommandRecord> records = simulation.takeCommands();
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(std::get<SetGapWidth>(records[0].command).width, 0.0);

  simulation.cancelJob(grip(1.0));
  simulation.requestSteps(1).get();
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_EQ(ends[1].outcome, ClampJobResult::Outcome::kCancelled);
  grip(0.0);
  EXPECT_TRUE(simulation.execute(Reset{ResetScope::kTime}, kTimeout).success);
  ASSERT_EQ(ends.size(), 3u);
  EXPECT_EQ(ends[2].outcome, ClampJobResult::Outcome::kFailed);
  grip(1.0);
  grip(0.0);
  simulation.stop();
  grip(0.0);
  ASSERT_EQ(ends.size(), 6u);
  EXPECT_EQ(ends[5].outcome, ClampJobResult::Outcome::kRefused) << "there is nobody to do it";
}

TEST(SimulationThread, WarnsOnceOfATargetInAnObstacle) {
  const std::string ball = "obstacles: {ball: {type: sphere, radius: 0.2, position: [0, 0, -1]}}\n";
  const Scene scene = parseScene(kScene + ball, "test");
  RunSettings settings = paused();
  std::vector<std::string> warnings;
  settings.onWarning = [&](const std::string& warning) { warnings.push_back(warning); };
  SimulationThread simulation(scene, settings);
  const auto send = [&](double z) {
    const Pose pose{Vec3(0.0, 0.0, z), Quat::Identity()};
    EXPECT_TRUE(simulation.execute(SetClampTarget{"left", pose}, kTimeout).success);
  };
  send(-0.7);
  EXPECT_TRUE(warnings.empty());
  send(-0.9);
  send(-1.0);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], testing::HasSubstr("clamp 'left' is told to go into obstacle 'ball'"));
  EXPECT_TRUE(simulation.execute(Reset{}, kTimeout).success);
  send(-0.9);
  EXPECT_EQ(warnings.size(), 2u);
}

TEST(SimulationThread, ARestoredRunKnowsWhatHadFailedBefore) {
  SimulationThread simulation(smallScene(), paused());
  const Stroke middle =
      strokeAlong({Vec3(-1.0, 0.02, 0.0), Vec3(1.0, 0.02, 0.0)}, Vec3::UnitZ(), 1.0);
  EXPECT_TRUE(simulation.execute(CutAlong{middle}, kTimeout).success);
  std::string bytes;
  EXPECT_TRUE(simulation.inspect([&](const Simulation& s) { bytes = s.save(); }, kTimeout).success);
  const std::size_t cut = simulation.takeEvents().events.size();
  ASSERT_GT(cut, 0u);
  EXPECT_TRUE(simulation.execute(Reset{}, kTimeout).success);
  EXPECT_TRUE(simulation.execute(Restore{bytes}, kTimeout).success);
  const FailureBatch batch = simulation.takeEvents();
  EXPECT_EQ(batch.resets, 2u);
  EXPECT_EQ(batch.before.size(), cut);
  EXPECT_TRUE(batch.events.empty());
  EXPECT_FALSE(simulation.execute(Restore{"rubbish"}, kTimeout).success);
  EXPECT_EQ(simulation.observe().whole->figures->pieces.size(), 2u);
}

TEST(SimulationThread, TellsTheTimeInOrder) {
  std::vector<double> times;
  RunSettings settings = paused();
  settings.onTime = [&](double time) { times.push_back(time); };
  {
    SimulationThread simulation(smallScene(), settings);
    simulation.requestSteps(3).get();
    simulation.execute(Reset{ResetScope::kTime}, kTimeout);
  }
  ASSERT_EQ(times.size(), 5u);
  EXPECT_EQ(times.front(), 0.0);
  EXPECT_TRUE(std::is_sorted(times.begin(), times.begin() + 4));
  EXPECT_EQ(times.back(), 0.0);
}

TEST(SimulationThread, HasTheContactsOfLayersWhenTheyAreAskedForAlsoWhilePaused) {
  SimulationThread simulation(
      parseScene("{self_contact: true, cloth: {particles: [5, 5]}}", "test"), paused());
  ASSERT_TRUE(simulation.observe().snapshot->layers);
  EXPECT_FALSE(simulation.observe().snapshot->contactPoints);
  simulation.setContactsWanted(true);
  EXPECT_TRUE(eventually([&] { return simulation.observe().snapshot->contactPoints.has_value(); }));
  simulation.requestSteps(1).get();
  EXPECT_TRUE(simulation.observe().snapshot->contactPoints);
  simulation.setContactsWanted(false);
  simulation.requestSteps(1).get();
  EXPECT_FALSE(simulation.observe().snapshot->contactPoints);
}

TEST(SimulationThread, APaceChangesAtOnce) {
  SimulationThread simulation(smallScene(), {0.001, false, 1, nullptr});  // a step takes 17 s
  ASSERT_TRUE(eventually([&] { return simulation.observe().snapshot->step == 1; }));
  simulation.setRealTimeFactor(0.0);
  EXPECT_TRUE(eventually([&] { return simulation.observe().snapshot->step > 10; }));
  EXPECT_EQ(simulation.observe().realTimeFactorAsked, 0.0);
}

TEST(SimulationThread, StoppingAnswersWhoWaits) {
  SimulationThread simulation(smallScene(), paused());
  std::future<StepResult> steps = simulation.requestSteps(SimulationThread::kMaxSteps);
  simulation.stop();
  const StepResult result = steps.get();
  if (!result.result.success) {
    EXPECT_THAT(result.result.message, testing::HasSubstr("shutting"));
  }
  EXPECT_FALSE(simulation.execute(Reset{}, kTimeout).success);
  EXPECT_FALSE(simulation.requestSteps(1).get().result.success);
}

}  // namespace
}  // namespace cloth_sim
