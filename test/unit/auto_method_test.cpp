#include "scene/auto_method.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "cloth_sim/cloth/stable_step.h"
#include "cloth_sim/scene/build.h"
#include "cloth_sim/scene/load.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Two methods for smooth scenes, one for contact, none for tearing.
AutoTable smallTable() {
  std::istringstream in(
      "# a remark\n"
      "class,error,solver,dt,scale,substep,longest_s,cost_s\n"
      "smooth,0.001,verlet,0.02,frequency,1.5,1,1e-7\n"
      "smooth,0.01,xpbd,0.02,cell,0.25,0.01,2e-7\n"
      "contact,0.01,xpbd,0.005,cell,0.25,0.002,2e-7\n");
  return readAutoTable(in);
}

const char* const kCloth = "cloth: {size: [0.5, 0.5], particles: [20, 20], fabric: interlock}\n";

Scene clothWith(const std::string& rest = "", const std::vector<std::string>& overrides = {}) {
  return parseScene(kCloth + rest, "t.yaml", overrides);
}

std::string refusal(const std::string& rest) {
  return testing_support::sceneErrorOf([&] { clothWith(rest); });
}

/// Fixture whose cache is an empty folder of the test's own.
class AutoMethod : public testing::Test {
 public:
  AutoMethod() {
    std::filesystem::remove_all(folder_);
    setenv("CLOTH_SIM_CACHE", folder_.c_str(), 1);
  }
  ~AutoMethod() override {
    unsetenv("CLOTH_SIM_CACHE");
    std::filesystem::remove_all(folder_);
  }

 protected:
  std::string folder_ = testing::TempDir() + "cloth_sim_auto_method_test";
};

TEST_F(AutoMethod, ClassesAreWhatAScenesNames) {
  EXPECT_EQ(classOf(clothWith()), SceneClass::kSmooth);
  EXPECT_EQ(classOf(clothWith("wind: {velocity: [1, 0, 0]}")), SceneClass::kSmooth);
  EXPECT_EQ(classOf(clothWith("obstacles: {floor: {type: plane}}")), SceneClass::kContact);
  EXPECT_EQ(classOf(clothWith("tearing: {ratio: 1.2}")), SceneClass::kTearing);
  EXPECT_EQ(classOf(clothWith("phases: [{name: a, tearing: {enabled: true, ratio: 1.2}}]")),
            SceneClass::kTearing);
}

TEST_F(AutoMethod, FrequenciesOfAPatchAreThoseOfTheCloth) {
  const Scene scene = clothWith();
  // Gershgorin's bound is a maximum over the particles, and a piece has one of each kind.
  EXPECT_NEAR(stepUnit(StepScale::kFrequency, scene.cloths[0]),
              0.5 * stableStep(buildModel(scene.cloths[0])), 1e-12);
  // Half the spacing: half the step.
  const Scene finer = clothWith("", {"cloth.particles=[39, 39]"});
  EXPECT_NEAR(stepUnit(StepScale::kFrequency, finer.cloths[0]) /
                  stepUnit(StepScale::kFrequency, scene.cloths[0]),
              0.5, 0.1);  // bend springs are not quite independent of the spacing
  EXPECT_DOUBLE_EQ(stepUnit(StepScale::kCell, scene.cloths[0]), std::sqrt(0.5 / 9.81) / 20);
}

TEST_F(AutoMethod, TakesTheCheapestThatKeepsTheError) {
  const Scene scene = clothWith("solver: {method: xpbd, dt: 0.02}");
  const SolverSpec loose = chooseFrom(smallTable(), scene, 0.02);
  EXPECT_EQ(loose.method, "xpbd");
  EXPECT_EQ(loose.dt, 0.02);
  // 0.25 sqrt(0.5 / 9.81) / 20 = 2.82 ms
  EXPECT_EQ(loose.parameters.at("substeps"), 8);
  const SolverSpec tight = chooseFrom(smallTable(), scene, 0.005);
  EXPECT_EQ(tight.method, "verlet");
  const double h = 0.02 / tight.parameters.at("substeps");
  EXPECT_LE(h, 0.75 * stableStep(buildModel(scene.cloths[0])) * (1.0 + 1e-9));
  EXPECT_GT(h, 0.6 * stableStep(buildModel(scene.cloths[0])));
}

TEST_F(AutoMethod, OfASoftClothIsTheExplicitOne) {
  const Scene soft = clothWith("solver: {method: xpbd, dt: 0.02}",
                               {"cloth.fabric={tensile_warp: 1, tensile_weft: 1, shear: 0, "
                                "bending: 0, areal_density: 1}"});
  EXPECT_EQ(chooseFrom(smallTable(), soft, 0.02).method, "verlet");
}

TEST_F(AutoMethod, DividesStepsThatTheTableDoesNotAllow) {
  const Scene scene =
      clothWith("obstacles: {floor: {type: plane}}\nsolver: {method: xpbd, dt: 0.02}");
  const SolverSpec chosen = chooseFrom(smallTable(), scene, 0.01);
  EXPECT_DOUBLE_EQ(chosen.dt, 0.005);
  EXPECT_EQ(chosen.parameters.at("substeps"), 3);  // of at most 2 ms
}

TEST_F(AutoMethod, RefusesErrorsThatNobodyMeasured) {
  try {
    chooseFrom(smallTable(), clothWith(), 1e-4);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("0.001"), HasSubstr("smooth"), HasSubstr("0.0001")));
  }
}

TEST_F(AutoMethod, TheBuiltInTableIsTheFileAndServesEveryClass) {
  std::ifstream file(std::string(CLOTH_SIM_SOURCE_DIR) + "/config/auto_methods.csv");
  std::ostringstream kept, built;
  writeAutoTable(kept, readAutoTable(file), "");
  writeAutoTable(built, builtInAutoTable(), "");
  EXPECT_EQ(kept.str(), built.str());
  for (const char* rest : {"", "obstacles: {floor: {type: plane}}", "tearing: {ratio: 1.2}"}) {
    EXPECT_NO_THROW(chooseFrom(builtInAutoTable(), clothWith(rest), 0.05)) << rest;
  }
}

TEST_F(AutoMethod, IsResolvedWhenASceneIsLoaded) {
  const Scene scene = clothWith("solver: {method: auto, error: 0.02, sleep: {after: 2}}");
  const SolverSpec expected = chooseFrom(builtInAutoTable(), clothWith(), 0.02);
  EXPECT_EQ(scene.solver.method, expected.method);
  EXPECT_EQ(scene.solver.parameters, expected.parameters);
  ASSERT_TRUE(scene.solver.choice);
  EXPECT_EQ(scene.solver.choice->error, 0.02);
  EXPECT_EQ(scene.solver.sleep->after, 2.0) << "is the scene's";
  EXPECT_FALSE(clothWith("solver: {method: xpbd}").solver.choice);
}

TEST_F(AutoMethod, RefusesWhatContradictsItselfWithOneLine) {
  EXPECT_THAT(refusal("solver: {method: auto}"), HasSubstr("solver.error: missing"));
  EXPECT_THAT(refusal("solver: {method: auto, error: 0}"), HasSubstr("solver.error"));
  EXPECT_THAT(refusal("solver: {method: auto, error: 0.01, substeps: 3}"), HasSubstr("substeps"));
  EXPECT_THAT(refusal("solver: {method: auto, error: 1.0e-12}"),
              AllOf(HasSubstr("t.yaml:2: solver"), HasSubstr("smallest")));
}

TEST_F(AutoMethod, PrefersWhatWasMeasuredOnTheVeryScene) {
  const Scene scene = clothWith("solver: {method: verlet, substeps: 3}");
  SolverSpec found = scene.solver;
  found.method = "rk4";
  found.dt = 0.01;
  found.parameters = completeParameters(findSolver("rk4"), {{"substeps", 7}});
  const AutoCache cache(autoCacheFile());
  cache.add("0123456789abcdef", 0.02, scene.solver);
  cache.add(scene.contentKey, 0.01, scene.solver);
  cache.add(scene.contentKey, 0.01, found);  // in place of the one before

  const Scene cached = clothWith("solver: {method: auto, error: 0.015}");
  EXPECT_EQ(cached.solver.method, "rk4");
  EXPECT_EQ(cached.solver.dt, 0.01);
  EXPECT_EQ(cached.solver.parameters.at("substeps"), 7);
  EXPECT_THAT(cached.solver.choice->source, HasSubstr(cache.file()));

  EXPECT_FALSE(cache.find(scene.contentKey, 0.009));  // not accurate enough
  for (const char* other : {"drag: 1\nsolver: {method: auto, error: 0.015}",
                            "solver: {method: auto, error: 0.015, dt: 0.02}"}) {
    EXPECT_THAT(clothWith(other).solver.choice->source, testing::Not(HasSubstr(cache.file())));
  }
}

TEST_F(AutoMethod, SaysWhichCacheIsBroken) {
  std::filesystem::create_directories(folder_);
  std::ofstream(autoCacheFile())
      << "scene,error,solver,dt,parameters\nabc,0.01,no_such,0.1,substeps=1\n";
  EXPECT_THAT(refusal("solver: {method: auto, error: 0.02}"),
              AllOf(HasSubstr(autoCacheFile()), HasSubstr("line 2"), HasSubstr("no_such")));
}

}  // namespace
}  // namespace cloth_sim
