/// \file Scenes of the package.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "cloth_sim/scene/load.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using namespace testing_support;

TEST(ShippedScenes, AllLoad) {
  for (const char* name : {"tear_seam", "tear_seam_explicit", "hang", "drape_sphere", "table_edge",
                           "wind", "cut", "curtain_relaxed", "curtain_hover", "curtain_gusts",
                           "explicit_hang", "explicit_blows_up"}) {
    SCOPED_TRACE(name);
    Scene scene;
    ASSERT_NO_THROW(scene = loadScene(shipped(name)));
    EXPECT_EQ(scene.name, name);
    EXPECT_FALSE(scene.phases.empty());
  }
}

TEST(ShippedScenes, AllTakeAnotherMethodWithItsSubsteps) {
  for (const auto& file : std::filesystem::directory_iterator(sceneFolder())) {
    if (file.path().extension() != ".yaml") continue;
    SCOPED_TRACE(file.path());
    Scene scene;
    ASSERT_NO_THROW(scene =
                        loadScene(file.path(), {"solver.method=verlet", "solver.substeps=1500"}));
    EXPECT_EQ(scene.solver.method, "verlet");
    EXPECT_EQ(scene.solver.parameters, (SolverParameters{{"substeps", 1500.0}}));
  }
}

/// The figures of the published demo.
void expectTheTearingRun(const Scene& scene) {
  const int n = 128;
  EXPECT_EQ(scene.cloths[0].columns, n);
  EXPECT_EQ(scene.cloths[0].rows, n);
  EXPECT_EQ(scene.cloths[0].pose.position, Vec3(0.0, 0.0, 0.9));
  EXPECT_EQ(scene.cloths[0].randomOffset, Vec3(0.05, 0.05, 0.0));
  std::vector<std::string> names;
  for (const PhaseSpec& phase : scene.phases) names.push_back(phase.name);
  EXPECT_THAT(names, testing::ElementsAre("drop", "settle", "attach", "close", "lift",
                                          "lower_and_notch", "pull_and_tear", "stop"));
  EXPECT_EQ(scene.clamps[0].patch->column, 2);
  EXPECT_EQ(scene.clamps[0].patch->row, n / 2);
  EXPECT_EQ(scene.clamps[1].patch->column, n - 3);
  EXPECT_EQ(scene.clamps[1].patch->row, n / 2);
  for (const ClampSpec& clamp : scene.clamps) {
    EXPECT_EQ(clamp.patch->radius, 3);
    EXPECT_EQ(clamp.gapOpen, 0.12);
    EXPECT_EQ(clamp.gapClosed, 0.02);
  }
  const double cell = 1.0 / (n - 1);
  const double seam = scene.tearing.seam->path.front().x();
  const int middle = n / 2;
  EXPECT_GT(seam, (middle - 1) * cell);
  EXPECT_LT(seam, middle * cell);
  EXPECT_EQ(scene.tearing.ratio[0], 3.0);
  EXPECT_EQ((*scene.phases[6].ratio)[0], 1.2);
  // The notch cuts the threads of 12 rows, 0 to 11: it ends between row 11 and row 12.
  const double notchEnd = scene.phases[5].notches.at(0).back().y();
  EXPECT_GT(notchEnd, 11.0 * cell);
  EXPECT_LT(notchEnd, 12.0 * cell);
}

TEST(ShippedScenes, TearSeamHasThePublishedFigures) {
  expectTheTearingRun(loadScene(shipped("tear_seam")));
  expectTheTearingRun(loadScene(shipped("tear_seam_explicit")));
}

TEST(ShippedScenes, ExplicitTearSeamHasThePublishedConstants) {
  const Scene scene = loadScene(shipped("tear_seam_explicit"));
  EXPECT_EQ(scene.solver.method, "symplectic_euler");
  EXPECT_NEAR(scene.solver.dt / scene.solver.parameters.at("substeps"), 0.04 / 128.0, 1e-15);
  EXPECT_EQ(scene.cloths[0].raw->constant, (std::array<double, 3>{3e4, 3e4, 0.0}));
  EXPECT_TRUE(scene.cloths[0].raw->perStretch);
  EXPECT_EQ(scene.cloths[0].raw->dashpot, 1e4 / 128.0);
  EXPECT_EQ(scene.cloths[0].particleMass, 1.0);
  EXPECT_FALSE(scene.cloths[0].springs.bend);
  EXPECT_EQ(scene.drag, 1.0);
  EXPECT_EQ(scene.obstacles[0].friction, 0.0);
  EXPECT_EQ(scene.obstacles[0].tangentialDecay, 2.0);
}

}  // namespace
}  // namespace cloth_sim
