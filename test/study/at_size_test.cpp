/// \file The four errors of a run beside its cost, on a small cloth.

#include "study/at_size.h"

#include <gtest/gtest.h>

#include <algorithm>
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
  const std::vector<AtSizeRun> runs = atSizeRuns({16});
  ASSERT_EQ(runs.size(), 2U);
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

TEST(AtSize, TheTableHasAColumnForEachError) {
  std::ostringstream out;
  writeAtSize(out, {AtSizeRow()});
  EXPECT_EQ(out.str().substr(0, out.str().find('\n')),
            "scene,particles,method,substeps,iterations,error,ms_per_frame,real_time_factor,"
            "position_error,strain_error,strain_error_999,force_error,energy_error,"
            "estimated_position,estimated_strain,status");
}

}  // namespace
}  // namespace cloth_sim
