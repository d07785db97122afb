#include <gtest/gtest.h>

#include "cloth_sim/scene/phase_script.h"

namespace cloth_sim {
namespace {

PhaseSpec phaseNamed(const std::string& name) {
  PhaseSpec phase;
  phase.name = name;
  return phase;
}

PhaseSpec lasting(const std::string& name, double duration) {
  PhaseSpec phase = phaseNamed(name);
  phase.timeout = duration;
  return phase;
}

PhaseObservation at(double time) {
  PhaseObservation now;
  now.time = time;
  return now;
}

/// A script of one phase with these conditions, begun at time 0.
PhaseScript waitingFor(const PhaseConditions& until) {
  PhaseSpec phase = phaseNamed("wait");
  phase.until = until;
  PhaseScript script({phase});
  script.start(0.0);
  return script;
}

/// Tells whether the phase is over after these observations.
bool endsAfter(PhaseScript script, const std::vector<PhaseObservation>& observations) {
  for (const PhaseObservation& now : observations) script.update(now);
  return script.status() == ScriptStatus::kDone;
}

TEST(PhaseScript, EmptyScriptStaysIdle) {
  PhaseScript script({});
  EXPECT_EQ(script.start(0.0), nullptr);
  EXPECT_EQ(script.update(at(1.0)), nullptr);
  EXPECT_EQ(script.status(), ScriptStatus::kIdle);
  EXPECT_TRUE(script.history().empty());
}

TEST(PhaseScript, NothingRunsBeforeStart) {
  PhaseScript script({lasting("a", 1.0)});
  EXPECT_EQ(script.current(), nullptr);
  EXPECT_EQ(script.update(at(5.0)), nullptr);
  EXPECT_EQ(script.status(), ScriptStatus::kIdle);
  EXPECT_EQ(script.names(), std::vector<std::string>{"a"});
}

TEST(PhaseScript, RunsPhasesInOrderAndRecordsThem) {
  PhaseScript script({lasting("a", 1.0), lasting("b", 0.5)});
  ASSERT_NE(script.start(2.0), nullptr);
  EXPECT_EQ(script.current()->name, "a");
  EXPECT_EQ(script.update(at(2.9)), nullptr);
  const PhaseSpec* begun = script.update(at(3.0));
  ASSERT_NE(begun, nullptr);
  EXPECT_EQ(begun->name, "b");
  EXPECT_EQ(begun, script.current());
  EXPECT_EQ(script.update(at(3.5)), nullptr);

  EXPECT_EQ(script.status(), ScriptStatus::kDone);
  EXPECT_EQ(script.current(), nullptr);
  ASSERT_EQ(script.history().size(), 2u);
  EXPECT_EQ(script.history()[0].name, "a");
  EXPECT_EQ(script.history()[0].start, 2.0);
  EXPECT_EQ(script.history()[0].end, 3.0);
  EXPECT_EQ(script.history()[1].name, "b");
  EXPECT_EQ(script.history()[1].start, 3.0);
  EXPECT_EQ(script.history()[1].end, 3.5);
  EXPECT_FALSE(script.history()[1].timedOut);
}

TEST(PhaseScript, NoConditionHoldsByDefault) {
  PhaseConditions until;
  EXPECT_TRUE(until.none());
  until.contact = true;
  EXPECT_FALSE(until.none());
}

TEST(PhaseScript, WithNeitherConditionNorTimeoutItWaitsForACommand) {
  PhaseScript script = waitingFor({});
  script.update(at(1e6));
  EXPECT_EQ(script.status(), ScriptStatus::kRunning);
  EXPECT_FALSE(script.history().back().end.has_value());
}

TEST(PhaseScript, ElapsedForgivesRoundOffOfSummedSteps) {
  PhaseConditions until;
  until.elapsed = 1.0;
  double time = 0.0;
  for (int step = 0; step < 60; ++step) time += 1.0 / 60.0;
  ASSERT_NE(time, 1.0) << "the sum is exact: the test shows nothing";
  EXPECT_TRUE(endsAfter(waitingFor(until), {at(time)}));
  EXPECT_FALSE(endsAfter(waitingFor(until), {at(time - 1.0 / 60.0)}));
}

TEST(PhaseScript, MeanSpeedMustStayBelowWithoutABreak) {
  PhaseConditions until;
  until.meanSpeedBelow = 0.1;
  until.meanSpeedFor = 1.0;
  const auto moving = [](double time, double speed) {
    PhaseObservation now = at(time);
    now.meanSpeed = speed;
    return now;
  };
  EXPECT_TRUE(endsAfter(waitingFor(until), {moving(0.5, 0.05), moving(1.5, 0.05)}));
  EXPECT_FALSE(endsAfter(waitingFor(until), {moving(0.5, 0.05), moving(1.4, 0.05)}));
  EXPECT_FALSE(
      endsAfter(waitingFor(until), {moving(0.5, 0.05), moving(1.0, 0.1), moving(1.5, 0.05)}));
  EXPECT_TRUE(endsAfter(waitingFor(until), {moving(0.5, 0.05), moving(1.0, 0.1), moving(1.5, 0.05),
                                            moving(2.5, 0.05)}));
}

TEST(PhaseScript, MeanSpeedIsWantedOnlyWhereAPhaseWaitsForIt) {
  PhaseSpec falls;
  falls.name = "fall";
  falls.until.elapsed = 1.0;
  PhaseSpec rests;
  rests.name = "rest";
  rests.until.meanSpeedBelow = 0.1;
  PhaseScript script({falls, rests});
  EXPECT_FALSE(script.wantsMeanSpeed()) << "before it starts";
  script.start(0.0);
  EXPECT_FALSE(script.wantsMeanSpeed());
  script.jump("rest", 0.5);
  EXPECT_TRUE(script.wantsMeanSpeed());
}

TEST(PhaseScript, ContactCountsOnceMadeInThePhase) {
  PhaseConditions until;
  until.contact = true;
  until.elapsed = 1.0;
  PhaseObservation touching = at(0.5);
  touching.inContact = true;
  EXPECT_TRUE(endsAfter(waitingFor(until), {touching, at(1.0)}));
  EXPECT_FALSE(endsAfter(waitingFor(until), {at(0.5), at(1.0)}));
}

TEST(PhaseScript, ContactOfTheLastPhaseDoesNotCount) {
  PhaseSpec second = phaseNamed("b");
  second.until.contact = true;
  PhaseScript script({lasting("a", 1.0), second});
  script.start(0.0);
  PhaseObservation touching = at(1.0);
  touching.inContact = true;
  script.update(touching);
  script.update(at(1.5));
  EXPECT_EQ(script.status(), ScriptStatus::kRunning);
}

TEST(PhaseScript, WaitsForClampsPiecesAndBrokenSprings) {
  PhaseObservation now = at(0.1);
  now.clampsAtTarget = true;
  now.clampsClosed = true;
  now.pieces = 3;
  now.broken = 7;
  PhaseConditions until;

  until.clampsAtTarget = true;
  EXPECT_TRUE(endsAfter(waitingFor(until), {now}));
  EXPECT_FALSE(endsAfter(waitingFor(until), {at(0.1)}));
  until = {};
  until.clampsClosed = true;
  EXPECT_TRUE(endsAfter(waitingFor(until), {now}));
  EXPECT_FALSE(endsAfter(waitingFor(until), {at(0.1)}));
  until = {};
  until.piecesAtLeast = 3;
  EXPECT_TRUE(endsAfter(waitingFor(until), {now}));
  EXPECT_FALSE(endsAfter(waitingFor(until), {at(0.1)}));
  until = {};
  until.brokenAtLeast = 7;
  EXPECT_TRUE(endsAfter(waitingFor(until), {now}));
  EXPECT_FALSE(endsAfter(waitingFor(until), {at(0.1)}));
}

TEST(PhaseScript, AllConditionsMustHoldAtOnce) {
  PhaseConditions until;
  until.piecesAtLeast = 2;
  until.clampsAtTarget = true;
  PhaseObservation torn = at(0.1);
  torn.pieces = 2;
  PhaseObservation arrived = at(0.2);
  arrived.clampsAtTarget = true;
  EXPECT_FALSE(endsAfter(waitingFor(until), {torn, arrived}));
  arrived.pieces = 2;
  EXPECT_TRUE(endsAfter(waitingFor(until), {torn, arrived}));
}

/// "a" waits for a contact for 1 s at most, then comes "b".
PhaseScript impatient(OnTimeout onTimeout) {
  PhaseSpec first = lasting("a", 1.0);
  first.until.contact = true;
  first.onTimeout = onTimeout;
  PhaseScript script({first, phaseNamed("b")});
  script.start(0.0);
  return script;
}

TEST(PhaseScript, TimeoutFailsTheScript) {
  PhaseScript script = impatient(OnTimeout::kFail);
  EXPECT_EQ(script.update(at(1.0)), nullptr);
  EXPECT_EQ(script.status(), ScriptStatus::kFailed);
  EXPECT_EQ(script.current(), nullptr);
  ASSERT_EQ(script.history().size(), 1u);
  EXPECT_TRUE(script.history()[0].timedOut);
  EXPECT_EQ(script.history()[0].end, 1.0);
  EXPECT_EQ(script.update(at(2.0)), nullptr);
}

TEST(PhaseScript, TimeoutGoesOnIfAskedTo) {
  PhaseScript script = impatient(OnTimeout::kContinue);
  ASSERT_NE(script.update(at(1.0)), nullptr);
  EXPECT_EQ(script.current()->name, "b");
  EXPECT_TRUE(script.history()[0].timedOut);
}

TEST(PhaseScript, AConditionThatHoldsAtTheTimeoutIsInTime) {
  PhaseScript script = impatient(OnTimeout::kFail);
  PhaseObservation touching = at(1.0);
  touching.inContact = true;
  ASSERT_NE(script.update(touching), nullptr);
  EXPECT_FALSE(script.history()[0].timedOut);
}

TEST(PhaseScript, JumpEndsThePhaseAndGoesOnFromThere) {
  PhaseScript script({lasting("a", 9.0), lasting("b", 9.0), lasting("c", 1.0)});
  script.start(0.0);
  const PhaseSpec* begun = script.jump("c", 0.5);
  ASSERT_NE(begun, nullptr);
  EXPECT_EQ(begun->name, "c");
  ASSERT_EQ(script.history().size(), 2u);
  EXPECT_EQ(script.history()[0].end, 0.5);
  EXPECT_FALSE(script.history()[0].timedOut);
  EXPECT_EQ(script.history()[1].start, 0.5);
  script.update(at(1.5));
  EXPECT_EQ(script.status(), ScriptStatus::kDone);
}

TEST(PhaseScript, JumpRestartsADoneOrFailedScript) {
  PhaseScript script = impatient(OnTimeout::kFail);
  script.update(at(1.0));
  ASSERT_NE(script.jump("a", 2.0), nullptr);
  EXPECT_EQ(script.status(), ScriptStatus::kRunning);
  EXPECT_EQ(script.update(at(2.5)), nullptr);
  EXPECT_EQ(script.status(), ScriptStatus::kRunning) << "its time-out counts from the jump";
  EXPECT_EQ(script.history()[0].end, 1.0) << "what is over is not ended again";
}

TEST(PhaseScript, JumpToAnUnknownPhaseChangesNothing) {
  PhaseScript script({lasting("a", 1.0)});
  script.start(0.0);
  EXPECT_EQ(script.jump("z", 0.5), nullptr);
  EXPECT_EQ(script.current()->name, "a");
  EXPECT_EQ(script.history().size(), 1u);
}

TEST(PhaseScript, TellsWhatEndsThePhase) {
  PhaseConditions until;
  until.piecesAtLeast = 2;
  until.meanSpeedBelow = 0.02;
  until.meanSpeedFor = 0.5;
  PhaseSpec wait = phaseNamed("wait");
  wait.until = until;
  wait.timeout = 4.0;
  PhaseScript script({lasting("first", 1.0), wait, phaseNamed("last")});
  EXPECT_EQ(script.progressText(), "no phase has begun");
  script.start(0.0);
  EXPECT_EQ(script.progressText(), "'first' (1 of 3) lasts until t = 1 s");
  script.update(at(1.0));
  EXPECT_EQ(
      script.progressText(),
      "'wait' (2 of 3) lasts until the mean speed has stayed below 0.02 m/s for 0.5 s and the "
      "cloth is in 2 pieces, or until t = 5 s, when the run fails");
  EXPECT_EQ(script.failureText(), "");
  PhaseScript failing = script;
  failing.update(at(5.0));
  EXPECT_EQ(
      failing.failureText(),
      "phase 'wait' did not end within its time-out of 4 s; it lasts until the mean speed has "
      "stayed below 0.02 m/s for 0.5 s and the cloth is in 2 pieces");
  EXPECT_EQ(failing.progressText(), failing.failureText());
  script.jump("last", 3.0);
  EXPECT_EQ(script.progressText(), "'last' (3 of 3) lasts until another phase is begun");
  EXPECT_EQ(PhaseScript({}).progressText(), "the scene has no phases");
}

}  // namespace
}  // namespace cloth_sim
