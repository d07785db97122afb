/// \file Commands that change settings while a simulation runs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloth_sim/sim/simulation.h"
#include "cloth_sim/threads/thread_limit.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

Scene hanging(double stiffness) {
  Scene scene;
  scene.cloths[0].columns = scene.cloths[0].rows = 9;
  scene.cloths[0].width = scene.cloths[0].height = 0.4;
  scene.cloths[0].pins = {{0, 8}, {8, 8}};
  Fabric& fabric = scene.cloths[0].fabric;
  for (double* value : {&fabric.tensileWarp, &fabric.tensileWeft, &fabric.shear, &fabric.bending}) {
    *value *= stiffness;
  }
  fabric.damping = 1e-4;
  scene.solver.parameters = completeParameters(findSolver("xpbd"), {});
  return scene;
}

TEST(Tuning, StiffnessIsThatOfAStifferFabric) {
  Simulation turned(hanging(1.0));
  ASSERT_TRUE(turned.apply(SetStiffness{3.0}).success);
  const Simulation wanted(hanging(3.0));
  const auto& springs = turned.model().springs.slots();
  ASSERT_EQ(springs.size(), wanted.model().springs.slots().size());
  for (std::size_t k = 0; k < springs.size(); ++k) {
    const Spring& spring = wanted.model().springs.slots()[k];
    EXPECT_NEAR(springs[k].stiffness / spring.stiffness, 1.0, 1e-12) << k;
    EXPECT_NEAR(springs[k].damping / spring.damping, 1.0, 1e-12) << k;
  }
}

TEST(Tuning, StiffnessIsThatOfTheBendingEnergyToo) {
  Scene scene = hanging(1.0);
  scene.cloths[0].plate = true;
  Scene stiff = hanging(3.0);
  stiff.cloths[0].plate = true;
  Simulation turned(scene);
  ASSERT_TRUE(turned.apply(SetStiffness{3.0}).success);
  Simulation wanted(stiff);
  std::vector<Vec3> fold = wanted.state().x.values();
  for (Vec3& x : fold) x.z() = 2.0 * x.x() * x.x();
  const double energy = wanted.model().bending.energy(fold);
  ASSERT_GT(energy, 0.0);
  EXPECT_NEAR(turned.model().bending.energy(fold) / energy, 1.0, 1e-12);
  Simulation soft(scene);
  for (Simulation* each : {&turned, &wanted, &soft}) {  // the solver's copy, too
    for (int k = 0; k < 20; ++k) each->step();
    ASSERT_FALSE(each->failed());
  }
  double largest = 0.0;
  for (VertexId v = 0; v < turned.model().particleCount(); ++v) {
    // Their numbers are rounded differently, and cloth that buckles amplifies that.
    EXPECT_LT((turned.state().x[v] - wanted.state().x[v]).norm(), 1e-6) << v;
    largest = std::max(largest, (soft.state().x[v] - wanted.state().x[v]).norm());
  }
  EXPECT_GT(largest, 1e-4);
}

TEST(Tuning, StiffnessIsNotOnTopOfAnEarlierOne) {
  Simulation simulation(hanging(1.0));
  const double before = simulation.model().springs[0].stiffness;
  ASSERT_TRUE(simulation.apply(SetStiffness{5.0}).success);
  ASSERT_TRUE(simulation.apply(SetStiffness{2.0}).success);
  EXPECT_NEAR(simulation.model().springs[0].stiffness / before, 2.0, 1e-12);
  EXPECT_EQ(simulation.tuning().stiffness, 2.0);
}

TEST(Tuning, EveryMethodTakesTheNewStiffness) {
  for (const SolverInfo& method : solverRegistry()) {
    Scene scene = hanging(1.0);
    scene.solver.method = method.name;
    scene.solver.parameters = completeParameters(method, {});
    // 40 us: a third of the damping's retardation time, which is what explicit Euler stands.
    scene.solver.parameters.at("substeps") = std::isinf(method.stabilityLimit) ? 10 : 400;
    const ThreadLimit one(1);  // so small a cloth is not worth more
    Simulation usual(scene);
    Simulation soft(scene);
    ASSERT_TRUE(soft.apply(SetStiffness{0.05}).success);
    for (int k = 0; k < 12; ++k) {
      usual.step();
      soft.step();
    }
    ASSERT_FALSE(usual.failed()) << method.name << ": " << usual.failure();
    if (method.name == "pbd") continue;  // its stiffness follows from passes, not from the fabric
    EXPECT_GT(soft.observeMaxStretch() - 1.0, 2.0 * (usual.observeMaxStretch() - 1.0))
        << method.name;
  }
}

TEST(Tuning, SpringsMadeByACutAreAsStiffAsTheOthers) {
  Simulation simulation(hanging(1.0));
  ASSERT_TRUE(simulation.apply(SetStiffness{4.0}).success);
  Simulation wanted(hanging(4.0));
  Stroke stroke = strokeAlong({Vec3(-1.0, 0.013, 0.0), Vec3(1.0, 0.013, 0.0)}, Vec3::UnitZ(), 1.0);
  for (Simulation* each : {&simulation, &wanted}) {
    ASSERT_TRUE(each->apply(CutAlong{stroke}).success);
    ASSERT_EQ(each->pieces(), 2);
  }
  const auto& springs = simulation.model().springs.slots();
  ASSERT_EQ(springs.size(), wanted.model().springs.slots().size());
  for (std::size_t k = 0; k < springs.size(); ++k) {
    if (!springs[k].exists()) continue;
    EXPECT_NEAR(springs[k].stiffness / wanted.model().springs.slots()[k].stiffness, 1.0, 1e-12);
  }
}

TEST(Tuning, WindMovesTheClothUntilItIsTakenAway) {
  Scene scene = hanging(1.0);
  scene.gravity.setZero();
  Simulation simulation(scene);
  Wind wind;
  wind.velocity = Vec3(0.0, 0.0, 5.0);
  ASSERT_TRUE(simulation.apply(SetWind{wind}).success);
  EXPECT_EQ(simulation.tuning().wind->velocity, wind.velocity);
  simulation.step();
  EXPECT_GT(meanSpeed(simulation.state()), 0.0);
  ASSERT_TRUE(simulation.apply(SetWind{}).success);
  EXPECT_FALSE(simulation.tuning().wind);
}

TEST(Tuning, AResetBringsBackTheScene) {
  Simulation simulation(hanging(1.0));
  const Spring before = simulation.model().springs[0];
  ASSERT_TRUE(simulation.apply(SetStiffness{4.0}).success);
  ASSERT_TRUE(simulation.apply(SetGravity{Vec3::Zero()}).success);
  ASSERT_TRUE(simulation.apply(SetWind{Wind()}).success);
  ASSERT_TRUE(simulation.apply(Reset{}).success);
  EXPECT_EQ(simulation.tuning().stiffness, 1.0);
  EXPECT_EQ(simulation.tuning().gravity, hanging(1.0).gravity);
  EXPECT_FALSE(simulation.tuning().wind);
  EXPECT_EQ(simulation.model().springs[0].stiffness, before.stiffness);
}

TEST(Tuning, QuasiStaticMotionIsDeclaredBySceneAndCommandAndReset) {
  Scene scene = hanging(1.0);
  scene.quasiStatic = true;
  Simulation simulation(scene);
  EXPECT_TRUE(simulation.tuning().quasiStatic);
  ASSERT_TRUE(simulation.apply(SetQuasiStatic{false}).success);
  EXPECT_FALSE(simulation.tuning().quasiStatic);
  ASSERT_TRUE(simulation.apply(Reset{}).success);
  EXPECT_TRUE(simulation.tuning().quasiStatic);
}

TEST(Tuning, BadValuesAreRefusedAndChangeNothing) {
  Simulation simulation(hanging(1.0));
  for (const double scale : {0.0, -1.0, 1e9, static_cast<double>(NAN)}) {
    EXPECT_FALSE(simulation.apply(SetStiffness{scale}).success) << scale;
  }
  Wind wind;
  wind.velocity.x() = NAN;
  EXPECT_FALSE(simulation.apply(SetWind{wind}).success);
  wind = Wind();
  wind.density = -1.0;
  EXPECT_FALSE(simulation.apply(SetWind{wind}).success);
  EXPECT_EQ(simulation.tuning().stiffness, 1.0);
  EXPECT_FALSE(simulation.tuning().wind);
}

TEST(Tuning, APulledParticleFollowsAndIsFreeAfterwards) {
  Simulation simulation(hanging(1.0));
  const VertexId corner = 0;
  const Vec3 start = simulation.state().x[corner];
  const auto ray = [&](double along) {
    return PullParticle{true, {start + Vec3(along, 0.0, 1.0), -Vec3::UnitZ()}};
  };
  ASSERT_TRUE(simulation.apply(ray(0.0)).success);
  ASSERT_TRUE(simulation.apply(ray(-0.02)).success);
  for (int k = 0; k < 30; ++k) simulation.step();
  EXPECT_NEAR((simulation.state().x[corner] - start - Vec3(-0.02, 0.0, 0.0)).norm(), 0.0, 1e-4);
  ASSERT_TRUE(simulation.apply(PullParticle{false, {}}).success);
  for (int k = 0; k < 30; ++k) simulation.step();
  EXPECT_LT(simulation.state().x[corner].z(), start.z() - 0.05) << "it falls";
  PullParticle miss = ray(0.0);
  miss.ray.origin.x() += 5.0;
  EXPECT_FALSE(simulation.apply(miss).success);
}

TEST(Tuning, APullThatNobodyKeepsUpEndsAfterATimeResetToo) {
  Simulation simulation(hanging(1.0));
  const VertexId corner = 0;
  const Vec3 start = simulation.state().x[corner];
  const PullParticle pull{true, {start + Vec3(0.0, 0.0, 1.0), -Vec3::UnitZ()}};
  for (int k = 0; k < 120; ++k) {
    ASSERT_TRUE(simulation.apply(pull).success);
    simulation.step();
  }
  EXPECT_NEAR((simulation.state().x[corner] - start).norm(), 0.0, 1e-6);
  ASSERT_TRUE(simulation.apply(Reset{ResetScope::kTime}).success);
  for (int k = 0; k < 90; ++k) simulation.step();  // 1.5 s, and it is held for 1 s
  EXPECT_GT((simulation.state().x[corner] - start).norm(), 0.01) << "it is free";
}

}  // namespace
}  // namespace cloth_sim
