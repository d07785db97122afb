#include "motions.h"

#include <cstdio>

#include "motion_cloth.h"

namespace cloth_sim::bench {
namespace {

/// A run with the setting that its row shows.
struct Runner {
  Runner(const Motion& motion, const MotionSetting& settings, std::unique_ptr<MovingCloth> cloth)
      : setting(settings), run(motion, std::move(cloth)) {}
  MotionSetting setting;
  MotionRun run;
};

void addPeers(const Motion& motion, std::vector<Runner>& runners) {
  for (const bool bends : {true, false}) {
    const std::string name = bends ? "Bullet" : "Bullet without bending";
    for (const int substeps : {8, 12, 20, 40, 80}) {
      const MotionSetting setting{name, substeps, 4, 0.0};
      runners.emplace_back(motion, setting, bulletMotion(motion, {substeps, 4, bends}));
    }
  }
}

void addOwn(const Motion& motion, std::vector<Runner>& runners) {
  std::vector<MotionSetting> settings;
  for (const int n : {10, 20, 40, 80}) settings.push_back({"xpbd", n, 0, 0.0});
  for (const int n : {8, 10, 20, 40}) settings.push_back({"line_xpbd", n, 0, 0.0});
  settings.push_back({"line_xpbd", 0, 0, 0.01});
  for (const MotionSetting& setting : settings) {
    runners.emplace_back(motion, setting, movingCloth(motion, setting));
  }
}

void print(const AtSizeRow& row) {
  std::printf("  %-24s %5d x %d %5g  %8.2f ms %9.3g %9.3g %9.3g %9.3g  %s\n",
              row.setting.method.c_str(), row.setting.substeps, row.setting.iterations,
              row.setting.error, 1e3 * row.cost, row.errors.position, row.errors.strain,
              row.errors.force, row.errors.energy, row.status.c_str());
  std::fflush(stdout);
}

std::vector<AtSizeRow> compare(const Motion& motion) {
  std::printf("%s: errors of positions, strain, force, energy\n", motion.name.c_str());
  const MotionReference reference = makeReference(motion);
  std::vector<AtSizeRow> rows{rowOfReference(motion, reference)};
  print(rows.back());
  std::vector<Runner> runners;
  addPeers(motion, runners);
  addOwn(motion, runners);
  for (bool goesOn = true; goesOn;) {
    goesOn = false;
    for (Runner& runner : runners) goesOn = runner.run.advance() || goesOn;
  }
  for (const Runner& runner : runners) {
    rows.push_back(rowOfRun(motion, runner.setting, runner.run.record(), reference));
    print(rows.back());
  }
  return rows;
}

}  // namespace

std::vector<AtSizeRow> compareInMotion(int particles) {
  std::vector<AtSizeRow> rows;
  for (const MotionMaker motion : {edgeSwing, cornerHang}) {
    const std::vector<AtSizeRow> of = compare(motion(particles));
    rows.insert(rows.end(), of.begin(), of.end());
  }
  return rows;
}

}  // namespace cloth_sim::bench
