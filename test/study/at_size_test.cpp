/// \file The four errors of a run beside its cost, on a small cloth.

#include "study/at_size.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace cloth_sim {
namespace {

const AtSizeRow& rowOf(const std::vector<AtSizeRow>& rows, const std::string& method,
                       int substeps) {
  return *std::find_if(rows.begin(), rows.end(), [&](const AtSizeRow& row) {
    return row.setting.method == method && row.setting.substeps == substeps;
  });
}

TEST(AtSize, ErrorsFallWithSubstepsAndLinesAreStifferThanSingleSprings) {
  const std::vector<AtSizeRun> runs = atSizeRuns({16}, {"swing"});
  ASSERT_EQ(runs.size(), 1U);
  ASSERT_EQ(runs[0].scene, "swing");
  const std::vector<AtSizeRow> rows = runs[0].make();
  EXPECT_LT(rows[0].errors.position, 1e-4);
  EXPECT_LT(rows[0].errors.strain, 1e-4);
  for (const AtSizeRow& row : rows) {
    EXPECT_GT(row.cost, 0.0) << row.setting.method;
    const bool isReference = &row == rows.data();
    EXPECT_EQ(row.status, isReference ? "reference" : "ok") << row.setting.method;
  }
  const AtSizeRow& few = rowOf(rows, "line_xpbd", 10);
  const AtSizeRow& many = rowOf(rows, "line_xpbd", 40);
  EXPECT_LT(many.errors.position, 0.5 * few.errors.position);
  EXPECT_LT(many.errors.energy, 0.5 * few.errors.energy);
  EXPECT_LT(few.errors.strain, 0.1 * rowOf(rows, "xpbd", 10).errors.strain);
  EXPECT_GT(rowOf(rows, "projective", 1).errors.position, 0.1) << "is right at rest only";
  EXPECT_GT(few.estimatedPosition, 0.5 * few.errors.position);
}

TEST(AtSize, RunsAreThoseOfTheScenesAndSizesThatAreAskedFor) {
  EXPECT_EQ(atSizeRuns({16, 32}).size(), 2 * atSizeScenes().size());
  const std::vector<AtSizeRun> few = atSizeRuns({32, 256}, {"swing", "drop"});
  ASSERT_EQ(few.size(), 3U) << "above 128, only the swing runs";
  EXPECT_EQ(few[1].scene, "swing");
  EXPECT_EQ(few[1].particles, 256);
}

MotionErrors errorsOf(const Motion& motion, const MotionSetting& setting,
                      const MotionReference& reference) {
  return compareMotions(motion, recordMotion(motion, setting), reference.record);
}

TEST(AtSize, ADrapeIsJudgedByItsShapeAtRest) {
  const Motion motion = ballDrop(16);
  const MotionReference reference = makeReference(motion);
  const MotionErrors fine = errorsOf(motion, {"line_xpbd", 40, 0, 0.0}, reference);
  EXPECT_LT(fine.restRadius, 0.02);
  EXPECT_LT(fine.restStrain, 0.01);
  EXPECT_LT(fine.restElastic, 0.5);
  EXPECT_TRUE(std::isnan(fine.force)) << "nothing holds the cloth";
  EXPECT_TRUE(std::isnan(compareMotions(edgeSwing(16), recordMotion(edgeSwing(16), {"xpbd", 10}),
                                        recordMotion(edgeSwing(16), {"xpbd", 20}))
                             .restRadius));
}

TEST(AtSize, TheTableHoldsTheClothByFriction) {
  const Motion motion = tableEdge(16);
  const MotionReference reference = makeReference(motion);
  const std::vector<Vec3>& end = reference.record.trajectory.positions.back();
  EXPECT_GT(end[0].z(), -0.01) << "this side lies on the table";
  EXPECT_LT(end[15].z(), -0.2) << "this one hangs over its edge";
  EXPECT_LT(errorsOf(motion, {"line_xpbd", 40, 0, 0.0}, reference).position, 0.02);
}

TEST(AtSize, ClampsLiftTheTowelOffTheGroundAndShakeIt) {
  const Motion motion = shakenTowel(16);
  const MotionReference reference = makeReference(motion);
  const MotionRecord& record = reference.record;
  for (const Vec3& x : record.trajectory.positions.back()) EXPECT_GT(x.z(), 0.05);
  const ClothSpec& cloth = motion.scene.cloths[0];
  const double weight = cloth.fabric.arealDensity * motion.scene.gravity.norm();
  EXPECT_GT(record.samples.back().force.norm(), 0.2 * weight);
  EXPECT_LT(errorsOf(motion, {"line_xpbd", 40, 0, 0.0}, reference).position, 0.02);
}

TEST(AtSize, TheSeamTearsAtTheForceOfTheReference) {
  const Motion motion = seamPull(24);
  const MotionReference reference = makeReference(motion);
  const MotionRecord& record = reference.record;
  EXPECT_GT(record.peakForce, 100.0);
  EXPECT_GT(record.separation, record.trajectory.times.back()) << "samples end as the tear begins";
  EXPECT_LT(record.separation, 0.8);
  const MotionErrors errors = errorsOf(motion, {"line_xpbd", 0, 0, 0.01}, reference);
  EXPECT_LT(errors.peakForce, 0.05);
  EXPECT_LT(errors.force, 0.02);
  EXPECT_LT(errors.strain, 0.01);
  EXPECT_TRUE(std::isfinite(errors.separation)) << "it comes apart";
  EXPECT_GT(errorsOf(motion, {"xpbd", 20, 0, 0.0}, reference).peakForce, 0.5) << "is too soft";
  MotionRecord early = record;
  early.samples.resize(2);
  EXPECT_TRUE(std::isnan(compareMotions(motion, early, record).position)) << "it tears too early";
}

TEST(AtSize, TheTableHasAColumnForEachError) {
  std::ostringstream out;
  writeAtSize(out, {AtSizeRow()});
  EXPECT_EQ(out.str().substr(0, out.str().find('\n')),
            "scene,particles,method,substeps,iterations,error,ms_per_frame,real_time_factor,"
            "position_error,strain_error,strain_error_999,force_error,energy_error,"
            "rest_strain_error,rest_elastic_error,rest_radius_error,"
            "peak_force_error,separation_error,"
            "estimated_position,estimated_strain,status");
}

}  // namespace
}  // namespace cloth_sim
