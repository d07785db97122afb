#include "at_size.h"

#include <algorithm>
#include <limits>
#include <ostream>

namespace cloth_sim {
namespace {

constexpr double kNoEstimate = std::numeric_limits<double>::quiet_NaN();

constexpr int kMostForAll = 128;      ///< particles per side; above, only few runs are made
constexpr int kMostForTouching = 64;  ///< above, no tr_bdf2 in contact, where it breaks

std::vector<MotionSetting> fewSettings() {
  return {{"line_xpbd", 20, 0, 0.0}, {"line_xpbd", 40, 0, 0.0}, {"line_xpbd", 0, 0, 0.01}};
}

std::vector<MotionSetting> allSettings(bool withSlow) {
  std::vector<MotionSetting> all;
  for (const int n : {10, 20, 40, 80}) all.push_back({"xpbd", n, 0, 0.0});
  for (const int n : {8, 10, 14, 20, 30, 40}) all.push_back({"line_xpbd", n, 0, 0.0});
  for (const double error : {0.02, 0.01}) all.push_back({"line_xpbd", 0, 0, error});
  all.push_back({"projective", 1, 1, 0.0});
  all.push_back({"projective", 1, 10, 0.0});
  all.push_back({"projective", 10, 1, 0.0});
  all.push_back({"projective", 20, 2, 0.0});
  all.push_back({"implicit_euler", 1, 8, 0.0});
  if (withSlow) all.push_back({"tr_bdf2", 4, 8, 0.0});
  return all;
}

std::vector<MotionSetting> settingsFor(const Motion& motion) {
  const int particles = motion.scene.cloths[0].columns;
  if (particles > kMostForAll) return fewSettings();
  return allSettings(motion.scene.obstacles.empty() || particles <= kMostForTouching);
}

AtSizeRow rowOf(const Motion& motion, const MotionSetting& setting, const MotionRecord& run) {
  AtSizeRow row;
  row.scene = motion.name;
  row.particles = motion.scene.cloths[0].columns;
  row.setting = setting;
  row.cost = run.cost;
  row.estimatedPosition = run.estimate ? run.estimate->largestPosition : kNoEstimate;
  row.estimatedStrain = run.estimate ? run.estimate->largestStrain : kNoEstimate;
  return row;
}

std::vector<AtSizeRow> measure(const Motion& motion) {
  const MotionReference reference = makeReference(motion);
  std::vector<AtSizeRow> rows{rowOfReference(motion, reference)};
  for (const MotionSetting& setting : settingsFor(motion)) {
    rows.push_back(rowOfRun(motion, setting, recordMotion(motion, setting), reference));
  }
  return rows;
}

}  // namespace

AtSizeRow rowOfReference(const Motion& motion, const MotionReference& reference) {
  AtSizeRow row = rowOf(motion, reference.setting, reference.record);
  row.errors = reference.own;
  row.status = "reference";
  return row;
}

AtSizeRow rowOfRun(const Motion& motion, const MotionSetting& setting, const MotionRecord& run,
                   const MotionReference& reference) {
  AtSizeRow row = rowOf(motion, setting, run);
  row.errors = compareMotions(motion, run, reference.record);
  row.status = run.failure.empty() ? "ok" : run.failure;
  return row;
}

std::vector<std::string> atSizeScenes() {
  std::vector<std::string> names;
  for (const MotionMaker motion : motionMakers()) names.push_back(motion(2).name);
  return names;
}

std::vector<AtSizeRun> atSizeRuns(const std::vector<int>& particles,
                                  const std::vector<std::string>& only) {
  std::vector<AtSizeRun> runs;
  for (const MotionMaker motion : motionMakers()) {
    const std::string name = motion(2).name;
    const bool isAsked = only.empty() || std::count(only.begin(), only.end(), name) > 0;
    for (const int n : particles) {
      if (!isAsked || (n > kMostForAll && motion != edgeSwing)) continue;
      runs.push_back({name, n, [motion, n] { return measure(motion(n)); }});
    }
  }
  return runs;
}

void writeAtSize(std::ostream& out, const std::vector<AtSizeRow>& rows) {
  out << "scene,particles,method,substeps,iterations,error,ms_per_frame,real_time_factor,"
         "position_error,strain_error,strain_error_999,force_error,energy_error,"
         "rest_strain_error,rest_elastic_error,rest_radius_error,"
         "peak_force_error,separation_error,"
         "estimated_position,estimated_strain,status\n";
  for (const AtSizeRow& row : rows) {
    const MotionSetting& setting = row.setting;
    const MotionErrors& errors = row.errors;
    out << row.scene << ',' << row.particles << ',' << setting.method << ',' << setting.substeps
        << ',' << setting.iterations << ',' << setting.error << ',' << 1e3 * row.cost << ','
        << 1.0 / (60.0 * row.cost) << ',' << errors.position << ',' << errors.strain << ','
        << errors.strain999 << ',' << errors.force << ',' << errors.energy << ','
        << errors.restStrain << ',' << errors.restElastic << ',' << errors.restRadius << ','
        << errors.peakForce << ',' << errors.separation << ',' << row.estimatedPosition << ','
        << row.estimatedStrain << ',' << row.status << '\n';
  }
}

}  // namespace cloth_sim
