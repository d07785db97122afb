/// \file Steps that end early: where a spring passes a limit, with every method.

#include <gtest/gtest.h>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

constexpr double kDt = 0.01;  // [s]
constexpr int kSubsteps = 7;

/// A cloth that flies apart along u, too soft to matter: by 1 % in a step.
class LimitedStep : public testing::TestWithParam<std::string> {
 protected:
  LimitedStep() : model_(buildModel(softCloth())) {
    controls_.gravity.setZero();
    solver_ = makeSolver(findSolver(GetParam()), model_, kSubsteps);
  }

  static ClothSpec softCloth() {
    Fabric soft = fabricPreset("silk");
    soft.tensileWarp = 0.01;
    soft.tensileWeft = 0.01;
    soft.shear = 0.01;
    soft.damping = 0.0;
    return clothOf(4, 4, 0.1, soft);
  }

  State apart() const {
    State state = flatState(model_);
    for (VertexId v = 0; v < model_.particleCount(); ++v) state.v[v].x() = state.x[v].x();
    return state;
  }
  /// Returns the distance of the first two particles [m].
  static double length(const State& state) { return (state.x[1] - state.x[0]).norm(); }
  /// Limits their distance to the one that they reach after a fraction of the step.
  void limitAt(double fraction) {
    controls_.limits = {{0, 1, (1.0 + fraction * kDt) * length(apart())}};
  }
  StepReport step(State& state, double done) {
    return solver_->step(model_, state, controls_, none_, {kDt, 1.0, done});
  }

  Model model_;
  Controls controls_;
  Contacts none_;
  std::unique_ptr<Solver> solver_;
};

/// All but `pbd`, which lets nothing stretch.
std::vector<std::string> yieldingNames() {
  std::vector<std::string> names = solverNames();
  names.erase(std::remove(names.begin(), names.end(), "pbd"), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(Registry, LimitedStep, testing::ValuesIn(yieldingNames()),
                         [](const auto& test) { return test.param; });

TEST_P(LimitedStep, EndsAfterTheSubstepInWhichItIsPassed) {
  State state = apart();
  limitAt(0.5);
  const StepReport report = step(state, 0.0);
  EXPECT_TRUE(report.passedLimit);
  EXPECT_NEAR(report.fraction, 4.0 / kSubsteps, 1e-12);
  EXPECT_NEAR(state.t, 4.0 / kSubsteps * kDt, 1e-15);
  EXPECT_EQ(report.substeps, kSubsteps);
  EXPECT_NEAR(length(state), length(apart()) * (1.0 + state.t), 1e-6);
}

TEST_P(LimitedStep, GoesOnAsIfItHadNotEnded) {
  State whole = apart();
  const StepReport unbroken = step(whole, 0.0);
  EXPECT_FALSE(unbroken.passedLimit);
  EXPECT_EQ(unbroken.fraction, 1.0);

  State state = apart();
  limitAt(0.5);
  const StepReport first = step(state, 0.0);
  controls_.limits.clear();
  const StepReport second = step(state, first.fraction);
  EXPECT_FALSE(second.passedLimit);
  EXPECT_EQ(second.fraction, 1.0);
  EXPECT_EQ(second.substeps, kSubsteps);
  // To the bit: factorisations are made for it.
  EXPECT_EQ(first.substep, unbroken.substep);
  EXPECT_EQ(second.substep, unbroken.substep);
  EXPECT_NEAR(state.t, whole.t, 1e-15);
  for (VertexId v = 0; v < model_.particleCount(); ++v) {
    EXPECT_LT((state.x[v] - whole.x[v]).norm(), 1e-9) << v;
    EXPECT_LT((state.v[v] - whole.v[v]).norm(), 1e-6) << v;
  }
}

TEST_P(LimitedStep, ALimitThatIsNotPassedChangesNoBit) {
  State free = apart();
  step(free, 0.0);
  solver_ = makeSolver(findSolver(GetParam()), model_, kSubsteps);
  State state = apart();
  limitAt(2.0);
  EXPECT_FALSE(step(state, 0.0).passedLimit);
  EXPECT_EQ(stateHash(model_, state), stateHash(model_, free));
}

TEST_P(LimitedStep, HeldParticlesComeToTheirPlacesAtTheEndOfTheStep) {
  State state = apart();
  KinematicTarget target;
  target.vertex = 15;
  target.position = state.x[15] + Vec3(0.0, 0.0, 0.001);
  target.velocity = Vec3(0.0, 0.0, 0.1);
  controls_.kinematic = {target};
  limitAt(0.5);
  const StepReport first = step(state, 0.0);
  ASSERT_TRUE(first.passedLimit);
  EXPECT_NEAR(state.x[15].z(), 0.001 * first.fraction, 1e-12);
  controls_.limits.clear();
  step(state, first.fraction);
  EXPECT_NEAR(state.x[15].z(), 0.001, 1e-15);
}

/// A strip, pulled by 4 %.
Simulation strained(const std::string& tearing) {
  return Simulation(parseScene(R"(
cloth: {size: [0.4, 0.08], particles: [21, 5], fabric: silk}
solver: {method: xpbd, substeps: 20}
gravity: [0, 0, 0]
clamps:
  left: {patch: {particle: [0, 2], radius: 2}}
  right: {patch: {particle: [20, 2], radius: 2}}
phases:
  - {name: close, clamps: {all: {grasp: true}}, until: {clamps: closed}}
  - name: pull
    clamps: {right: {move_by: [0.012, 0, 0], speed: 0.1}}
    until: {elapsed: 1}
tearing: )" + tearing + "\n",
                               "strained"));
}

TEST(NearFailing, CostsNoBitUntilSomethingFails) {
  Simulation armed = strained("{ratio: {structural: 1.1, shear: 1.1, bend: 1.1}}");
  Simulation unarmed = strained("{enabled: false}");
  double nearest = 0.0;
  while (armed.time() < 1.5) {
    armed.step();
    unarmed.step();
    nearest = std::max(nearest, armed.observeMaxStretch());
    ASSERT_EQ(stateHash(armed.model(), armed.state()), stateHash(unarmed.model(), unarmed.state()))
        << armed.time();
  }
  EXPECT_EQ(armed.broken().total, 0);
  EXPECT_GT(nearest, 1.055);
}

TEST(NearFailing, SpringsFailWithinAStep) {
  Simulation simulation = strained("{ratio: 1.045}");
  while (simulation.time() < 1.5 && simulation.broken().total == 0) simulation.step();
  ASSERT_GT(simulation.broken().total, 0);
  const double steps = simulation.failures().front().time * 60.0;
  const double substeps = steps * 20.0;
  EXPECT_NEAR(substeps, std::round(substeps), 1e-6);
  EXPECT_GT(std::abs(steps - std::round(steps)), 0.04) << "only at the end of a step";
  EXPECT_NEAR(simulation.time() * 60.0, std::round(simulation.time() * 60.0), 1e-9);
}

}  // namespace
}  // namespace cloth_sim
