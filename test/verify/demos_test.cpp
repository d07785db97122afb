/// \file The shipped scenes that reproduce published demos: each ends as its authors describe.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

Simulation simulate(const std::string& scene, const std::vector<std::string>& overrides = {}) {
  return Simulation(loadScene(testing_support::shipped(scene), overrides));
}

void finish(Simulation& simulation) {
  while (!simulation.failed() && simulation.script().status() != ScriptStatus::kDone) {
    simulation.step();
  }
}

TEST(Demos, TheRelaxedCurtainComesToRestUnderItsTopRow) {
  Simulation simulation = simulate("curtain_relaxed");
  finish(simulation);
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_EQ(simulation.pieces(), 1);
  // At rest means that the phase ended by its condition, not by its time-out of 20 s.
  EXPECT_LT(simulation.time(), 19.0);
  // Gravity pulls every row down by g h^2 a step, and three half-corrections can only give back so
  // much: the springs that bear more rows are the longer ones.
  const State& state = simulation.state();
  const Grid& grid = *simulation.model().cloths[0].grid;
  const auto length = [&](int row) {
    return (state.x[grid.vertex(32, row)] - state.x[grid.vertex(32, row + 1)]).norm();
  };
  EXPECT_GT(length(48), length(16));
  EXPECT_GT(length(16), length(1));
  EXPECT_GT(length(48), 1.5 / 63.0);
}

TEST(Demos, TheHoveredCurtainIsRefinedWhereItIsCutAndHangsAroundTheHole) {
  Simulation simulation = simulate("curtain_hover");
  finish(simulation);
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_GT(simulation.model().particleCount(), 24 * 16 + 200);
  EXPECT_GT(simulation.broken().cut, 100);
  EXPECT_EQ(simulation.pieces(), 1) << "the cut ends 0.275 m from both sides";
  // A strip of 0.6 m by 2 x 33.5 mm has gone, with half a disc at each end of it.
  const double strip = 0.6 * 0.067 + M_PI * 0.0335 * 0.0335;
  EXPECT_NEAR(simulation.dropped().restArea, strip, 0.1 * strip);
  // No face is left without springs: all of the curtain hangs within its height of 0.75 m.
  for (const Vec3& x : simulation.state().x) EXPECT_GT(x.z(), 1.5 - 2.0 * 0.75);
}

TEST(Demos, TheCurtainInGustsTearsByItself) {
  Simulation simulation = simulate("curtain_gusts");
  finish(simulation);
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  EXPECT_GT(simulation.broken().torn, 40) << "the tear ran on from the notch";
  EXPECT_GE(simulation.pieces(), 2);
  Simulation calm =
      simulate("curtain_gusts", {"phases.gust.wind=null", "phases.gust_back.wind=null"});
  finish(calm);
  EXPECT_EQ(calm.pieces(), 1) << "not without the gusts";
}

TEST(Demos, ForwardEulerHoldsWhereDashpotsAreHeavyAndGravityWeak) {
  Simulation simulation = simulate("explicit_hang");
  finish(simulation);
  ASSERT_FALSE(simulation.failed()) << simulation.failure();
  // Its weight is 64 x 0.098 N; two corners bear it through springs of 50 N/m.
  EXPECT_LT(maxStretch(simulation.model(), simulation.state()), 1.1);
  EXPECT_LT(meanSpeed(simulation.state()), 0.05);
}

TEST(Demos, ForwardEulerBlowsUpUnderEarthsGravityAndSaysSo) {
  Simulation simulation = simulate("explicit_blows_up");
  finish(simulation);
  ASSERT_TRUE(simulation.failed());
  EXPECT_THAT(simulation.failure(), testing::HasSubstr("explicit_euler diverged"));
  for (const Vec3& x : simulation.state().x) EXPECT_TRUE(x.allFinite());
}

TEST(Demos, OtherMethodsHoldWhereForwardEulerBlowsUp) {
  for (const char* solver :
       {"{method: rk4, dt: 0.004, substeps: 1}", "{method: tr_bdf2, dt: 0.004}",
        "{method: implicit_euler, dt: 0.004}"}) {
    Simulation simulation = simulate("explicit_blows_up", {std::string("solver=") + solver});
    finish(simulation);
    EXPECT_FALSE(simulation.failed()) << solver << simulation.failure();
    EXPECT_LT(maxStretch(simulation.model(), simulation.state()), 1.6) << solver;
  }
}

}  // namespace
}  // namespace cloth_sim
