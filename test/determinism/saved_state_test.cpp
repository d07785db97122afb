/// \file A run that is saved and loaded continues with the same bits as an uninterrupted one, by
/// every method, with clamps, contact, tears and cuts. Files that are no state of the scene are
/// refused.

#include "cloth_sim/sim/saved_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "determinism/busy_scene.h"

namespace cloth_sim {
namespace {

using testing::HasSubstr;
using testing_support::busyScene;
using testing_support::hashOf;

constexpr int kParticles = 24;  ///< along each side

std::vector<std::string> methodNames() {
  std::vector<std::string> names;
  for (const SolverInfo& info : solverRegistry()) names.push_back(info.name);
  return names;
}

void run(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.step();
}

/// Applies commands of every kind.
void disturb(Simulation& simulation) {
  EXPECT_TRUE(simulation.apply(SetGravity{Vec3(0.1, 0.0, -9.0)}).success);
  EXPECT_TRUE(simulation.apply(SetTearing{true, {1.15, 1.3, 1.4}}).success);
  const Pose aside{Vec3(0.05, 0.0, 0.1)};
  EXPECT_TRUE(simulation.apply(MoveObstacle{"sphere", aside, Vec3(0.0, 0.5, 0.0)}).success);
  const Stroke across = strokeAlong({{-1, 0.13, 0}, {1, 0.27, 0}}, Vec3(0.0, 0.0, -1.0), 1.0);
  EXPECT_TRUE(simulation.apply(RefineMesh{{{Vec3(0.2, 0.2, 0.2)}, {0.1, 2, 0.0}}}).success);
  EXPECT_TRUE(simulation.apply(CutAlong{across}).success);
  const MovingPose away{Pose{Vec3(-0.7, 0.0, 0.4)}, Vec3(-0.5, 0.0, 0.0), Vec3::UnitZ(), 0.1};
  EXPECT_TRUE(simulation.apply(GuideClamp{"left", away}).success);
  EXPECT_TRUE(simulation.apply(SetGripForce{"right", 0.05}).success);  // too weak: the cloth slips
  const MovingPose hand{Pose{Vec3(0.0, 0.3, 0.1)}, Vec3(0.0, 0.4, 0.0), Vec3::Zero(), 0.2};
  EXPECT_TRUE(simulation.apply(GuideObstacle{"table", hand}).success);
  EXPECT_TRUE(simulation.apply(SetStiffness{1.1}).success);
  EXPECT_TRUE(simulation.apply(SetQuasiStatic{true}).success);
  EXPECT_TRUE(simulation.apply(SetWind{Wind{Vec3(0.0, 1.0, 0.5), 1.2, 1.0}}).success);
  ClampSpec more;
  more.name = "more";
  EXPECT_TRUE(simulation.apply(CreateClamp{more}).success);
}

/// Steps both simulations and compares their states after each step, and everything else at the
/// end.
void expectSameFuture(Simulation& straight, Simulation& loaded, int steps) {
  for (int k = 0; k < steps; ++k) {
    ASSERT_EQ(hashOf(straight), hashOf(loaded)) << "after " << k << " steps";
    straight.step();
    loaded.step();
  }
  EXPECT_EQ(straight.save(), loaded.save());
  EXPECT_EQ(straight.failure(), loaded.failure());
}

class SavedState : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Registry, SavedState, testing::ValuesIn(methodNames()),
                         [](const auto& test) { return test.param; });

TEST_P(SavedState, GoesOnAsIfNothingHadHappened) {
  Simulation straight(busyScene(GetParam(), kParticles));
  // At the start; in contact and not held; held and cut; while it tears.
  for (const int steps : {0, 4, 8, 12}) {
    run(straight, steps);
    if (steps == 8) disturb(straight);
    Simulation loaded(busyScene(GetParam(), kParticles));
    run(loaded, 3);  // load() must replace every trace of these steps
    loaded.load(straight.save());
    expectSameFuture(straight, loaded, 8);
  }
  EXPECT_GT(straight.broken().cut, 0) << "the scene was to be cut";
  EXPECT_TRUE(straight.failed() || straight.broken().torn > 0) << "the scene was to tear";
}

TEST_P(SavedState, SavingChangesNothing) {
  Simulation saved(busyScene(GetParam(), kParticles));
  Simulation alone(busyScene(GetParam(), kParticles));
  for (int k = 0; k < 20; ++k) {
    saved.step();
    const std::string bytes = saved.save();
    ASSERT_EQ(bytes, saved.save());
    alone.step();
    ASSERT_EQ(hashOf(saved), hashOf(alone)) << "step " << k;
  }
}

TEST_P(SavedState, ManySavesInARow) {
  Simulation straight(busyScene(GetParam(), kParticles));
  Simulation relay(busyScene(GetParam(), kParticles));
  for (int k = 0; k < 24; ++k) {
    if (k == 7) {
      disturb(straight);
      disturb(relay);
    }
    straight.step();
    relay.step();
    Simulation next(busyScene(GetParam(), kParticles));
    next.load(relay.save());
    relay = std::move(next);
    ASSERT_EQ(hashOf(straight), hashOf(relay)) << "step " << k;
  }
  EXPECT_EQ(straight.save(), relay.save());
}

/// All observable quantities of a simulation except its state.
TEST(SavedStateFigures, AreTheSame) {
  Simulation straight(busyScene("xpbd", kParticles));
  run(straight, 14);
  disturb(straight);
  run(straight, 20);
  Simulation loaded(busyScene("xpbd", kParticles));
  loaded.load(straight.save());
  const auto before = straight.snapshot();
  const auto after = loaded.snapshot();
  EXPECT_EQ(after->phase, before->phase);
  EXPECT_EQ(after->figures->pieces.size(), before->figures->pieces.size());
  EXPECT_EQ(after->broken.total, before->broken.total);
  EXPECT_EQ(after->topology->tornEdges, before->topology->tornEdges);
  EXPECT_EQ(after->clamps[0].contents.held, before->clamps[0].contents.held);
  EXPECT_EQ(after->clamps[0].wrench.force, before->clamps[0].wrench.force);
  EXPECT_EQ(after->obstacles[1].pose.position, before->obstacles[1].pose.position);
  ASSERT_GT(straight.failures().size(), 0U);
  EXPECT_EQ(loaded.failures().size(), straight.failures().size());
  EXPECT_EQ(loaded.takeEvents().size(), straight.takeEvents().size()) << "pending events";
  EXPECT_EQ(validationError(loaded.model().mesh), "");
}

/// Loads bytes that the simulation must refuse without a change. \return the text of the error.
std::string refusal(const std::string& bytes) {
  Simulation simulation(busyScene("xpbd", kParticles));
  run(simulation, 2);
  const std::string before = simulation.save();
  std::string message;
  try {
    simulation.load(bytes);
  } catch (const StateError& error) {
    message = error.what();
  }
  EXPECT_EQ(simulation.save() == before, !message.empty()) << "a refusal is what changes nothing";
  EXPECT_EQ(message.find('\n'), std::string::npos);
  return message;
}

TEST(SavedStateRefused, IfDamagedOrCutShortAnywhere) {
  Simulation simulation(busyScene("xpbd", kParticles));
  run(simulation, 5);
  const std::string good = simulation.save();
  EXPECT_EQ(refusal(good), "");
  for (const std::size_t at :
       {std::size_t{20}, std::size_t{60}, good.size() / 2, good.size() - 1}) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    EXPECT_NE(refusal(bad), "") << "byte " << at;
  }
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{7}, std::size_t{20}, good.size() / 2, good.size() - 1}) {
    EXPECT_NE(refusal(good.substr(0, length)), "") << "length " << length;
  }
  EXPECT_THAT(refusal(good + "x"), HasSubstr("damaged"));
  EXPECT_THAT(refusal("a text"), HasSubstr("no saved state"));
}

TEST(SavedStateRefused, IfOfAnotherVersion) {
  Simulation simulation(busyScene("xpbd", kParticles));
  std::string bytes = simulation.save();
  const std::size_t version = std::string("cloth_sim state\n").size() + 1;  // after the byte order
  ++bytes[version];
  const std::string next = std::to_string(kStateVersion + 1);
  EXPECT_THAT(refusal(bytes),
              HasSubstr("version " + next + " (expected " + std::to_string(kStateVersion) + ")"));
}

TEST(SavedStateRefused, IfOfAnotherScene) {
  Scene other = busyScene("xpbd", kParticles);
  EXPECT_EQ(refusal(Simulation(other).save()), "");
  other.seed = 4;  // another start with the same text
  EXPECT_THAT(refusal(Simulation(other).save()), HasSubstr("another scene"));
  EXPECT_THAT(refusal(Simulation(busyScene("verlet", kParticles)).save()),
              HasSubstr("another scene"));
  EXPECT_THAT(refusal(Simulation(busyScene("xpbd", 16)).save()), HasSubstr("another scene"));
}

}  // namespace
}  // namespace cloth_sim
