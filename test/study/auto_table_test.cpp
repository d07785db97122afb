#include <gmock/gmock.h>

#include <sstream>

#include "cloth_sim/scene/load.h"
#include "study/make_auto_table.h"
#include "study/reference.h"

namespace cloth_sim {
namespace {

StudyScene smoothScene() {
  return studyOf(parseScene("cloth: {size: [0.5, 0.5], particles: [10, 10], fabric: interlock}",
                            "smooth.yaml"),
                 0.5);
}

const char* const kHeader =
    "scene,solver,dt,substeps,iterations,cpu_s_per_sim_s,error,max_strain,status\n";

AutoTable tableOf(const std::string& rows, double ownError = 1e-8) {
  std::istringstream in(kHeader + rows);
  return makeAutoTable({smoothScene()}, readWorkPrecision(in), {{"smooth", ownError}});
}

TEST(MakeAutoTable, TakesTheLongestSubstepThatAndBelowWhichTheErrorIsKept) {
  const AutoTable table = tableOf(
      "smooth,xpbd,0.01,1,0,0.1,0.009,0,ok\n"  // by chance
      "smooth,xpbd,0.01,2,0,0.2,0.03,0,ok\n"
      "smooth,xpbd,0.01,4,0,0.4,0.009,0,ok\n"
      "smooth,xpbd,0.01,8,0,0.8,0.004,0,ok\n"
      "smooth,xpbd,0.01,16,0,nan,nan,nan,skipped\n");
  ASSERT_FALSE(table.empty());
  const AutoRow& row = table.front();
  EXPECT_EQ(row.error, 0.01);
  EXPECT_EQ(row.dt, 0.01);
  const double unit = stepUnit(StepScale::kCell, smoothScene().scene.cloths[0]);
  EXPECT_LT(row.substep * unit, 0.0025);
  EXPECT_GT(row.substep * unit, 0.5 * 0.0025);  // a margin, but not more
  EXPECT_DOUBLE_EQ(row.cost, 0.4 * 0.0025 / 100);
  EXPECT_EQ(table.back().error, 0.05);  // 0.1 would say the same
}

TEST(MakeAutoTable, KnowsNothingOfWhatDidNotConverge) {
  EXPECT_TRUE(tableOf("smooth,verlet,0.01,1,0,0.1,0.001,0,ok\n"
                      "smooth,verlet,0.01,2,0,0.2,nan,0,diverged\n")
                  .empty());
  EXPECT_TRUE(tableOf("smooth,pbd,0.01,1,16,0.1,0.001,0,ok\n"
                      "smooth,pbd,0.01,2,16,0.2,0.001,0,ok\n")
                  .empty());
  const std::string good =
      "smooth,verlet,0.01,1,0,0.1,0.001,0,ok\nsmooth,verlet,0.01,2,0,0.2,0.001,0,ok\n";
  EXPECT_EQ(tableOf(good).front().error, 0.001);
  EXPECT_EQ(tableOf(good, 0.001).front().error, 0.005);  // the reference is no better
}

TEST(MakeAutoTable, RefusesOtherTables) {
  std::istringstream in("scene,solver\n");
  EXPECT_THROW(readWorkPrecision(in), std::runtime_error);
}

/// The table was measured on the study's scenes; these are others.
class AutoKeepsItsError : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(AutoKeepsItsError, OnScenesThatWereNotMeasured) {
  const std::string folder = std::string(CLOTH_SIM_SOURCE_DIR) + "/config/study/";
  std::vector<std::string> overrides = GetParam();
  const std::string file = folder + overrides.front() + ".yaml";
  overrides.erase(overrides.begin());
  for (const double error : {0.05, 0.01}) {
    overrides.push_back("solver={method: auto, error: " + std::to_string(error) + "}");
    const StudyScene study = studyOf(loadScene(file, overrides), 0.4);
    const Reference reference = convergeReference(study, {0.1 * error, 3});
    const double measured = errorAgainst(reference, study, runScene(study));
    EXPECT_LE(measured, error) << study.scene.solver.method << ", "
                               << study.scene.solver.parameters.at("substeps") << " substeps";
    overrides.pop_back();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, AutoKeepsItsError,
    testing::Values(
        std::vector<std::string>{"hang_swing", "cloth.particles=[8, 8]", "cloth.fabric=silk"},
        std::vector<std::string>{"hang_swing", "cloth.particles=[24, 24]",
                                 "cloth.fabric=interlock"},
        std::vector<std::string>{"table_edge", "cloth.particles=[13, 7]",
                                 "cloth.fabric={preset: polyester, damping: 0.0005}"},
        std::vector<std::string>{"drape_sphere", "cloth.particles=[12, 12]", "drag=4"}));

}  // namespace
}  // namespace cloth_sim
