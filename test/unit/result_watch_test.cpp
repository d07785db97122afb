/// \file Warnings of the watch over results, and where it gives none.

#include <gtest/gtest.h>

#include <algorithm>

#include "cloth_sim/contact/collider.h"
#include "cloth_sim/sim/saved_state.h"
#include "cloth_sim/sim/simulation.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;
using Measure = ResultWatch::Measure;

/// A square metre of cotton that hangs from two corners.
Scene cornerHung(const std::string& method) {
  Scene scene;
  scene.cloths[0] = clothOf(33, 33, 1.0 / 32, fabricPreset("cotton"));
  scene.cloths[0].pose.orientation = Quat(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX()));
  scene.cloths[0].pins = {{0, 32}, {32, 32}};
  scene.drag = 0.5;
  scene.solver.method = method;
  scene.solver.parameters = completeParameters(findSolver(method), {});
  return scene;
}

void stepFor(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.step();
}

/// Feeds reports to a watch over a cloth that falls freely.
std::vector<ResultWarning> warningsAfter(const StepReport& report, int steps) {
  const Model model = buildModel(clothOf(5, 5, 0.1));
  State state = flatState(model);
  const Controls controls;
  const double dt = 1.0 / 60.0;
  ResultWatch watch(findSolver("line_xpbd"));
  for (int k = 1; k <= steps; ++k) {
    state.t += dt;
    for (Vec3& v : state.v) v += dt * controls.gravity;
    watch.observe(static_cast<std::uint64_t>(k), model, state, controls, {}, report);
  }
  EXPECT_LT(watch.largest(Measure::kStrain), 1e-3);
  return watch.warnings();
}

TEST(ResultWatch, SaysThatAClothIsSofterThanItsFabric) {
  Simulation simulation(cornerHung("xpbd"));
  stepFor(simulation, 60);
  ASSERT_EQ(simulation.warnings().size(), 1U);
  EXPECT_NE(simulation.warnings()[0].text.find("softer than its fabric"), std::string::npos);
}

TEST(ResultWatch, SaysNothingOfAClothThatForcesExplain) {
  Simulation simulation(cornerHung("line_xpbd"));
  stepFor(simulation, 60);
  EXPECT_TRUE(simulation.warnings().empty()) << simulation.warnings()[0].text;
}

TEST(ResultWatch, AveragesAddedMassAndResiduals) {
  StepReport report;
  report.addedMass = 0.5;
  EXPECT_TRUE(warningsAfter(report, 6).empty()) << "after one measurement";
  const std::vector<ResultWarning> heavy = warningsAfter(report, 60);
  ASSERT_EQ(heavy.size(), 1U);
  EXPECT_NE(heavy[0].text.find("heavier by 0.5 times its mass"), std::string::npos)
      << heavy[0].text;

  report = StepReport();
  report.residual = 100.0;
  const std::vector<ResultWarning> unsolved = warningsAfter(report, 60);
  ASSERT_EQ(unsolved.size(), 1U);
  EXPECT_NE(unsolved[0].text.find("unsolved"), std::string::npos) << unsolved[0].text;
}

/// Feeds a watch with a cloth at rest to which the method adds mass, and of which one particle is
/// moved at `speed` [m/s].
std::string warningOfPull(const std::string& method, double speed) {
  const Model model = buildModel(clothOf(5, 5, 0.1));
  State state = flatState(model);
  Controls controls;
  controls.kinematic = {{0, Vec3::Zero(), Vec3(speed, 0.0, 0.0)}};
  StepReport report;
  report.addedMass = 0.5;
  ResultWatch watch(findSolver(method));
  for (int k = 1; k <= 60; ++k) {
    state.t += 1.0 / 60.0;
    watch.observe(static_cast<std::uint64_t>(k), model, state, controls, {}, report);
  }
  const std::vector<ResultWarning> warnings = watch.warnings();
  EXPECT_EQ(warnings.size(), 1U);
  return warnings.empty() ? "" : warnings[0].text;
}

TEST(ResultWatch, HintsAtQuasiStaticWhereClampsPullSlowly) {
  const auto hints = [](const std::string& text) {
    return text.find("declare quasi_static") != std::string::npos;
  };
  EXPECT_TRUE(hints(warningOfPull("line_xpbd", 0.2)));
  EXPECT_FALSE(hints(warningOfPull("line_xpbd", 2.0))) << "not slow";
  EXPECT_FALSE(hints(warningOfPull("line_xpbd", 0.0))) << "pinned: nobody pulls";
  EXPECT_FALSE(hints(warningOfPull("xpbd", 0.2))) << "does not make use of it";
}

TEST(ResultWatch, SaysThatABudgetFellShort) {
  StepReport report;
  report.error = ErrorEstimate();
  EXPECT_TRUE(warningsAfter(report, 2).empty());
  report.error->sufficed = false;
  report.error->budget = 7;
  const std::vector<ResultWarning> warnings = warningsAfter(report, 2);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].about, ResultWatch::kMeasures);
  EXPECT_EQ(warnings[0].text, shortfallText(*report.error));
}

/// Warnings about a flat strip of two faces whose ends are drawn together, over a table, and stay
/// there. \param friction  of the table [-].
std::vector<ResultWarning> warningsOnTable(double friction) {
  const Model model = buildModel(clothOf(2, 2, 0.1));
  State state = flatState(model);
  for (Vec3& x : state.x) x.x() *= 0.5;
  Obstacle table;
  table.shape = PlaneShape();
  table.friction = friction;
  const Collider collider(table, 0.0);
  Contacts contacts;
  contacts.add(&collider).vertices = {0, 1, 2, 3};
  ResultWatch watch(findSolver("line_xpbd"));
  for (std::uint64_t k = 1; k <= 30; ++k) {
    state.t += 1.0 / 60.0;
    watch.observe(k, model, state, {}, contacts, {});
  }
  return watch.warnings();
}

TEST(ResultWatch, KnowsWhatAContactCanBear) {
  const std::vector<ResultWarning> slippery = warningsOnTable(0.3);
  ASSERT_EQ(slippery.size(), 1U);
  EXPECT_NE(slippery[0].text.find("out of balance"), std::string::npos) << slippery[0].text;
  // Any weight bears any force of springs at this friction.
  EXPECT_TRUE(warningsOnTable(1e6).empty());
}

/// A strip of a knit that hangs from its upper edge under a gravity at which the weight below
/// stretches its top by `strain` on average; more at the corners, which cannot become narrower [-].
Scene heavyStrip(double strain) {
  Scene scene = cornerHung("implicit_euler");
  ClothSpec& cloth = scene.cloths[0];
  cloth = clothOf(5, 9, 0.0125, fabricPreset("interlock"));
  cloth.pose.orientation = Quat(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX()));
  for (int column = 0; column < cloth.columns; ++column) cloth.pins.push_back({column, 8});
  const Fabric& fabric = cloth.fabric;
  scene.gravity.z() = -strain * fabric.tensileWeft / (fabric.arealDensity * cloth.height);
  scene.drag = 20.0;
  return scene;
}

bool saysThatNoFabricBearsIt(const Simulation& simulation) {
  const std::vector<ResultWarning> warnings = simulation.warnings();
  return std::any_of(warnings.begin(), warnings.end(), [](const ResultWarning& warning) {
    return warning.text.find("which no fabric bears") != std::string::npos;
  });
}

TEST(ResultWatch, SaysThatAClothIsStretchedBeyondWhatFabricsBear) {
  Simulation bears(heavyStrip(0.2));
  stepFor(bears, 120);
  EXPECT_GT(maxStretch(bears.model(), bears.state()), 1.2);
  EXPECT_LT(maxStretch(bears.model(), bears.state()), 1.4);
  EXPECT_FALSE(saysThatNoFabricBearsIt(bears));
  Simulation overloaded(heavyStrip(0.9));
  stepFor(overloaded, 120);
  EXPECT_GT(maxStretch(overloaded.model(), overloaded.state()), 1.9);
  EXPECT_TRUE(saysThatNoFabricBearsIt(overloaded));
  // Springs with constants of their own are no fabric.
  Scene raw = heavyStrip(0.9);
  raw.cloths[0].raw = RawSprings{{20.0, 20.0, 0.0}, false, 0.0};
  Simulation ofSprings(raw);
  stepFor(ofSprings, 120);
  EXPECT_GT(maxStretch(ofSprings.model(), ofSprings.state()), 1.5);
  EXPECT_FALSE(saysThatNoFabricBearsIt(ofSprings));
}

TEST(ResultWatch, SaysThatRawSpringsAreNotFollowed) {
  Scene scene = cornerHung("pbd");
  scene.cloths[0].raw = RawSprings{{1.0, 1.0, 0.0}, false, 0.0};
  Simulation simulation(scene);
  stepFor(simulation, 60);
  ASSERT_EQ(simulation.warnings().size(), 1U);
  EXPECT_NE(simulation.warnings()[0].text.find("out of balance"), std::string::npos);
}

TEST(ResultWatch, BeginsAnewAfterAReset) {
  Simulation simulation(cornerHung("xpbd"));
  stepFor(simulation, 60);
  ASSERT_FALSE(simulation.warnings().empty());
  EXPECT_TRUE(simulation.apply(Reset{ResetScope::kState}).success);
  EXPECT_TRUE(simulation.warnings().empty());
}

TEST(Adopt, GoesOnFromTheStateOfAnotherMethod) {
  Simulation first(cornerHung("xpbd"));
  stepFor(first, 10);
  Simulation second(cornerHung("line_xpbd"));
  EXPECT_THROW(second.load(first.save()), StateError);
  second.adopt(first.save());
  EXPECT_EQ(stateHash(second.model(), second.state()), stateHash(first.model(), first.state()));
  second.step();
  EXPECT_EQ(second.scene().solver.method, "line_xpbd");
  EXPECT_EQ(second.stepCount(), 11U);
}

TEST(Adopt, GoesOnFromAClothThatWasCut) {
  Simulation first(cornerHung("xpbd"));
  stepFor(first, 2);
  ASSERT_TRUE(first.apply(CutAlong{strokeAlong({{-0.2, 0, 0}, {0.2, 0, 0.1}}, Vec3::UnitY(), 0.5)})
                  .success);
  ASSERT_GT(first.broken().cut, 0);
  Simulation second(cornerHung("line_xpbd"));
  second.adopt(first.save());
  EXPECT_EQ(second.model().particleCount(), first.model().particleCount());
  stepFor(second, 5);
  EXPECT_FALSE(second.failed()) << second.failure();
}

}  // namespace
}  // namespace cloth_sim
