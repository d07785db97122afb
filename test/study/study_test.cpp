/// \file References, errors and limits of stability of the study.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "cloth_sim/scene/load.h"
#include "study/exact.h"
#include "study/stability.h"
#include "study/work_precision.h"
#include "unit/core_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

const char* const kScenes = CLOTH_SIM_SOURCE_DIR "/config/study";

/// A soft cloth that swings for six steps.
StudyScene smallStudy(const std::vector<std::string>& overrides = {}) {
  return studyOf(parseScene(R"(
cloth:
  size: [0.2, 0.2]
  particles: [5, 4]
  pose: {rpy: [0.5, 0.0, 0.0]}
  fabric: {tensile_warp: 20, tensile_weft: 15, shear: 5, bending: 1.0e-6, damping: 1.0e-3}
  bending: springs
  pins: [last_row]
drag: 0.5
)",
                            "small", overrides),
                 0.1);
}

TEST(StudyScenes, TheShippedOnesLoadAndFallIntoTheirKinds) {
  std::map<std::string, StudyScene> scenes;
  for (const std::string& name : studySceneNames()) {
    scenes.emplace(name, loadStudyScene(kScenes, name));
    EXPECT_EQ(scenes.at(name).samples.size(), 4U) << name;
    EXPECT_DOUBLE_EQ(scenes.at(name).samples.back(), scenes.at(name).duration) << name;
  }
  EXPECT_TRUE(scenes.at("hang_swing").isSmooth());
  EXPECT_TRUE(scenes.at("in_plane_wave").isSmooth());
  EXPECT_FALSE(scenes.at("drape_sphere").isSmooth());
  EXPECT_FALSE(scenes.at("table_edge").isSmooth());
  EXPECT_FALSE(scenes.at("seam_tear").isSmooth());
  EXPECT_TRUE(scenes.at("seam_tear").tearing);
}

TEST(StudyScenes, KeptReferencesAreThoseOfTheScenes) {
  for (const std::string& name : studySceneNames()) {
    const StudyScene study = loadStudyScene(kScenes, name);
    if (!study.isSmooth()) continue;
    const Reference reference = readReference(referenceFile(kScenes, name), study);
    EXPECT_LT(reference.ownError, 1e-7);
    ASSERT_EQ(reference.trajectory.positions.size(), 4U);
    EXPECT_EQ(reference.trajectory.positions[0].size(),
              static_cast<std::size_t>(study.scene.cloths[0].columns * study.scene.cloths[0].rows));
  }
}

TEST(References, SurviveTheirFile) {
  const StudyScene study = smallStudy();
  Reference reference = convergeReference(study, {1e-3, 4});
  const std::string file = testing::TempDir() + "/small.reference.csv";
  std::ofstream out(file);
  writeReference(out, study, reference);
  out.close();
  const Reference back = readReference(file, study);
  EXPECT_EQ(back.source, reference.source);
  // 12 digits of metres.
  EXPECT_LT(trajectoryError(back.trajectory, reference.trajectory, study.side()), 1e-11);
  // Another scene is not taken for it.
  EXPECT_THROW(readReference(file, smallStudy({"cloth.fabric.shear=5.001"})), std::runtime_error);
  EXPECT_THROW(readReference(file, smallStudy({"gravity=[0, 0, -9.8]"})), std::runtime_error);
}

TEST(References, ConvergedRunsAgreeWithCvode) {
  if (!canIntegrateExactly()) GTEST_SKIP() << "not installed: cvode";
  const StudyScene study = smallStudy();
  const Reference exact = integrateExactly(study);
  EXPECT_LT(exact.ownError, 1e-7);
  const Reference converged = convergeReference(study, {1e-5, 8});
  ASSERT_TRUE(converged.converged);
  // The error halves at least with the step, so what is left is less than the last difference.
  EXPECT_LE(trajectoryError(converged.trajectory, exact.trajectory, study.side()),
            converged.ownError);
}

TEST(References, OnlySmoothScenesAreIntegratedExactly) {
  if (!canIntegrateExactly()) GTEST_SKIP() << "not installed: cvode";
  EXPECT_THROW(integrateExactly(smallStudy({"obstacles={ground: {type: plane}}"})),
               std::invalid_argument);
  EXPECT_THROW(integrateExactly(smallStudy({"cloth.bending=plate"})), std::invalid_argument);
}

TEST(TrajectoryError, IsTheRootOfTheMeanSquareOverTheSide) {
  const Trajectory a{{1.0, 2.0}, {{Vec3(0, 0, 0), Vec3(1, 0, 0)}, {Vec3(0, 0, 0), Vec3(1, 0, 0)}}};
  Trajectory b = a;
  EXPECT_EQ(trajectoryError(a, b, 2.0), 0.0);
  b.positions[1][1] += Vec3(0, 3, 4);  // 25 m^2 over four places: 2.5 m
  EXPECT_DOUBLE_EQ(trajectoryError(a, b, 2.0), 1.25);
  b.positions[1].pop_back();
  EXPECT_TRUE(std::isinf(trajectoryError(a, b, 2.0)));
}

/// Every method on one scene, judged.
std::vector<WorkPrecisionRow> compareAll(const StudyScene& study, const Ladder& ladder) {
  const Reference reference = convergeReference(study, {1e-3, 4});
  std::vector<WorkPrecisionRow> rows;
  for (const SolverInfo& method : solverRegistry()) {
    for (const Climb& climb : climbs(method, study.scene.solver.dt, ladder)) {
      for (WorkPrecisionRow& row : measureClimb(study, climb, ladder, [](const std::string&) {})) {
        judge(reference, study, row);
        rows.push_back(std::move(row));
      }
    }
  }
  return rows;
}

TEST(WorkPrecision, EveryMethodHasEveryRowWhateverItMayCost) {
  const StudyScene study = smallStudy();
  Ladder ladder = quickLadder();
  ladder.substeps = {1, 2, 40};
  ladder.substepsWithIterations = {1, 2};
  std::size_t expected = 0;
  for (const SolverInfo& method : solverRegistry()) {
    for (const Climb& climb : climbs(method, study.scene.solver.dt, ladder)) {
      expected += climb.size();
    }
  }
  const std::vector<WorkPrecisionRow> rows = compareAll(study, ladder);
  EXPECT_EQ(rows.size(), expected);
  for (const WorkPrecisionRow& row : rows) {
    EXPECT_NE(row.run.outcome, Outcome::kRefused) << row.run.why;
    if (row.run.outcome == Outcome::kOk) {
      EXPECT_LE(row.error, 1.0);
    }
  }
  EXPECT_FALSE(paretoRows(rows).empty());
  ladder.mostPerRun = 0.0;  // only what nothing is known of yet is run
  const std::vector<WorkPrecisionRow> skipped = compareAll(study, ladder);
  EXPECT_EQ(skipped.size(), expected);
  EXPECT_EQ(skipped[1].run.outcome, Outcome::kSkipped);
}

// ---- stability --------------------------------------------------------------------------------

TEST(VibratingSystems, HaveTheFrequenciesOfTheirModels) {
  // Two masses on a spring: omega^2 = k (1/m0 + 1/m1).
  EXPECT_NEAR(makeOscillator().omega, std::sqrt(5e5 * (1.0 / 0.02 + 1.0 / 0.03)), 1e-6);
}

class StabilityLimits : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Registry, StabilityLimits, testing::ValuesIn(solverNames()),
                         [](const auto& test) { return test.param; });

TEST_P(StabilityLimits, OfTheOscillatorAreThoseOfTheRegistry) {
  const SolverInfo& method = findSolver(GetParam());
  const double measured = measureStability(method, makeOscillator()).inOmegaH.limit;
  if (method.stabilityLimit == 0.0 || std::isinf(method.stabilityLimit)) {
    EXPECT_EQ(measured, method.stabilityLimit);
  } else {
    EXPECT_NEAR(measured / method.stabilityLimit, 1.0, 0.03);
  }
}

}  // namespace
}  // namespace cloth_sim
