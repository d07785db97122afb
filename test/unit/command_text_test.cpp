/// \file Commands as bytes and as text; scenes as text.

#include "sim/command_text.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/saved_state.h"
#include "cloth_sim/sim/simulation.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

/// Returns a command of each kind, with numbers that decimal digits would not preserve.
std::vector<Command> someCommands() {
  const double third = 1.0 / 3.0;
  const double never = std::numeric_limits<double>::infinity();
  const Pose pose{Vec3(third, -0.0, 1e-300), Quat(0.6, 0.0, 0.8, 0.0)};
  Stroke stroke = strokeAlong({Vec3(third, 0.0, 0.0), Vec3::Ones()}, Vec3::UnitZ(), third);
  stroke.firstLayerOnly = true;
  stroke.halfWidth = third;
  const MovingPose moving{pose, Vec3(third, 0.0, 0.0), Vec3::UnitZ(), third};
  ClampSpec spec;
  spec.name = "third";
  spec.gripForce = third;
  return {SetClampTarget{"left", pose},
          GuideClamp{"left", moving},
          SetGripForce{"left", std::nullopt},
          SetGapWidth{"left", third},
          CreateClamp{spec},
          DeleteClamp{"third"},
          GuideObstacle{"sphere", moving},
          SetGrasp{"right", false},
          SetPhase{"pull"},
          SetGravity{Vec3(0.0, third, -9.81)},
          MoveObstacle{"sphere", pose, Vec3(third, 0.0, 0.0)},
          SetTearing{true, {1.1, never, 1.0 + third}},
          SetWind{Wind{Vec3(0.0, third, 1.0), 1.2, third}},
          SetStiffness{1.0 + third},
          SetQuasiStatic{true},
          PullParticle{true, {Vec3(third, 0.0, 1.0), -Vec3::UnitZ()}},
          CutAlong{stroke},
          RefineMesh{{{Vec3(third, 0.0, 0.0)}, {third, 4, 1e-3}}},
          Reset{ResetScope::kTime},
          Restore{std::string("a\0b", 3)},
          SetResolution{33}};
}

TEST(PackedCommand, ComesBackToTheBit) {
  const std::vector<Command> commands = someCommands();
  ASSERT_EQ(commands.size(), std::variant_size_v<Command>) << "one of each kind";
  for (const Command& command : commands) {
    const Command back = unpackCommand(packCommand(command));
    EXPECT_EQ(back.index(), command.index());
    EXPECT_EQ(packCommand(back), packCommand(command)) << commandKind(command);
    EXPECT_STREQ(commandKind(back), commandKind(command));
    EXPECT_FALSE(describeCommand(back).empty());
  }
  const auto target = std::get<SetClampTarget>(unpackCommand(packCommand(commands[0])));
  EXPECT_EQ(target.clamp, "left");
  EXPECT_EQ(target.pose.position, (Vec3(1.0 / 3.0, -0.0, 1e-300)));
  EXPECT_EQ(target.pose.orientation.coeffs(), Quat(0.6, 0.0, 0.8, 0.0).coeffs());
}

TEST(PackedCommand, IsRefusedIfItIsNone) {
  std::string bytes = packCommand(SetPhase{"pull"});
  EXPECT_THROW(unpackCommand(""), StateError);
  EXPECT_THROW(unpackCommand(bytes.substr(0, bytes.size() - 1)), StateError);
  ++bytes[1];  // the version, after the byte order
  EXPECT_THROW(unpackCommand(bytes), StateError);
}

/// The stored text of every shipped scene, with an override, gives the same scene again.
TEST(SceneText, IsTheSceneAgain) {
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(testing_support::sceneFolder())) {
    if (entry.path().extension() != ".yaml") continue;
    const bool several = loadScene(entry.path()).cloths.size() > 1;
    const std::string first = several ? "cloth.0" : "cloth";
    const Scene scene = loadScene(entry.path(), {first + ".pose.position=[0.1, 0.2, 3.0e-1]"});
    const Scene again = parseScene(scene.text, entry.path());
    EXPECT_EQ(again.text, scene.text) << entry.path();
    EXPECT_EQ(again.cloths[0].pose.position, Vec3(0.1, 0.2, 0.3)) << entry.path();
    EXPECT_EQ(again.solver.parameters, scene.solver.parameters) << entry.path();
    EXPECT_EQ(again.phases.size(), scene.phases.size()) << entry.path();
    if (++scenes > 4) continue;  // building one takes a while
    Simulation one(scene);
    Simulation other(again);
    one.step();
    other.step();
    EXPECT_EQ(stateHash(one.model(), one.state()), stateHash(other.model(), other.state()));
  }
  EXPECT_GT(scenes, 5);
}

TEST(SceneText, KeepsWhatIsQuotedQuoted) {
  const char* const yaml = R"(
cloth: {particles: [3, 3]}
obstacles: {"7": {type: plane}}
phases: [{name: "1", timeout: 1}, {name: "a: b #c"}]
)";
  const Scene scene = parseScene(yaml, "test");
  const Scene again = parseScene(scene.text, "test");
  ASSERT_EQ(again.phases.size(), 2U);
  EXPECT_EQ(again.phases[0].name, "1");
  EXPECT_EQ(again.phases[1].name, scene.phases[1].name);
  EXPECT_EQ(again.obstacles[0].name, "7");
}

/// A reset of the time leaves the cloth alone; a reset of the state leaves the time.
TEST(ResetScope, StateOrTime) {
  const Scene scene = parseScene(R"(
cloth: {size: [0.2, 0.2], particles: [5, 5], pins: [corner_00]}
obstacles: {ball: {type: sphere, radius: 0.05, position: [0, 0, -0.3], velocity: [0.3, 0, 0]}}
phases: [{name: first, timeout: 0.1}, {name: second}]
)",
                                 "test");
  Simulation simulation(scene);
  for (int k = 0; k < 12; ++k) simulation.step();
  const double end = simulation.time();
  ASSERT_EQ(simulation.script().history().size(), 2U);
  const Pose ball = simulation.colliders().all()[0].poseAt(end);

  ASSERT_TRUE(simulation.apply(Reset{ResetScope::kTime}).success);
  EXPECT_EQ(simulation.time(), 0.0);
  EXPECT_EQ(simulation.stepCount(), 0U);
  EXPECT_TRUE(simulation.colliders().all()[0].poseAt(0.0).position.isApprox(ball.position, 1e-12));
  EXPECT_EQ(simulation.script().current()->name, "second");
  simulation.step();
  EXPECT_EQ(simulation.script().current()->name, "second");

  ASSERT_TRUE(simulation.apply(Reset{ResetScope::kState}).success);
  EXPECT_EQ(simulation.stepCount(), 1U);
  const double now = simulation.time();
  EXPECT_EQ(now, scene.solver.dt);
  EXPECT_EQ(simulation.colliders().all()[0].poseAt(now).position, scene.obstacles[0].pose.position);
  Simulation fresh(scene);
  for (int k = 0; k < 20; ++k) {
    simulation.step();
    fresh.step();
  }
  // Other times, so other roundings of the ball's place: the same run but for those.
  EXPECT_TRUE(simulation.state().x[24].isApprox(fresh.state().x[24], 1e-9));
  EXPECT_NEAR(simulation.script().history().back().start - now,
              fresh.script().history().back().start, 1e-12);
}

}  // namespace
}  // namespace cloth_sim
